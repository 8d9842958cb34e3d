// Bringing the index up to date after an edit that touched k points, at the cost of k. A bucket's points stand in
// consecutive slots, so that a query reads them as after a full build. A bucket that outgrows its slots moves, whole,
// to new ones at the end; the slots that it leaves are empty until the next build or compaction.
#ifndef PALPATE_SHARED_HASH_UPDATE_H
#define PALPATE_SHARED_HASH_UPDATE_H
#include "shaders/shared/spatial_hash.h"

PALPATE_SHARED_BEGIN

const uint kNoBucket = 0xffffffffu;

// What an edit writes into the w of a normal until the end of its tick.
const float kMarkRefit = 1.0f;  // the normal waits to be fitted to its new surroundings
const float kMarkGiven = 2.0f;  // the point is as it was given

// One change of a point, on its way into the index.
struct PointMove {
  vec3 position;  // where it goes; model units
  uint id;
  vec3 normal;
  float mark;       // kMark...
  uint slot;        // where it stands; kEmptySlot when it is new
  uint fromBucket;  // kNoBucket when it is new
  uint toBucket;    // kNoBucket when it is taken away
  uint before;      // the move that arrived in toBucket before it, from 1 on; 0: none did
  uint room;        // first of the slots that toBucket outgrows its own for, where it is this point that it outgrows
                    // them by, or kEmptySlot; of a point that is gone, its number among those
};
PALPATE_SIZE(PointMove, 52);

// What stands in the mark of a bucket between an edit's first pass and its update, 0 otherwise: that it is listed, how
// many points arrive, and the move that arrived last, from 1 on. From that one on the others follow (PointMove.before).
const uint kMarkListed = 0x80000000u;
const uint kMarkArrival = 0x00800000u;
const uint kMarkMove = kMarkArrival - 1u;  // as many moves are there at most
PALPATE_FUNCTION uint arrivalsOf(uint mark) { return (mark & ~kMarkListed) / kMarkArrival; }

// Why an update was not carried out; the cloud is then as it was.
const uint kUpdateTooLarge = 1;  // more moves than there is room for
const uint kUpdateNoSlots = 2;   // no slots left for a bucket to grow
const uint kUpdateCrowded = 4;   // too many points arrive in one bucket
const uint kUpdateUnknown = 8;   // a point is not where the edit says

// Workgroups in the first axis of an indirect dispatch; loops cover what is beyond.
const uint kMaxUpdateGroups = 65535;
const uint kUpdateWorkgroup = 256;
// Points that may arrive in one bucket in one tick. They are put into order by comparing each with each.
const uint kMaxArrivals = 255;
// A bucket that moves gets room for half as many points again as it then has, and a few.
const uint kSpareInBucket = 8;
PALPATE_FUNCTION uint roomToGrow(uint points) { return points + points / 2u + kSpareInBucket; }
// The capacity of a bucket that held `capacity` points at most and is to hold so many, of points that come one by one.
PALPATE_FUNCTION uint capacityFor(uint capacity, uint points) {
  while (capacity < points) capacity = roomToGrow(capacity + 1u);
  return capacity;
}

// Buckets that change while compacting are noted once each: a bit of a map says so, and the list stands behind the map.
PALPATE_FUNCTION uint dirtyListFrom(HashGrid grid) { return grid.bucketMask / 32u + 1u; }

// Counters of one update. The first kUpdateBegins bytes are empty between updates.
struct HashUpdate {
  uint moves;
  uint touched;
  uint arrivals;        // of buckets where more arrive than a subgroup holds
  uint grown;           // slots that buckets take at the end
  uint refused;         // kUpdate... for which an update is not carried out, but a full build may be
  uint wanted;          // slots that new points have taken before a full build
  uint failed;          // kUpdate...
  uint changed;         // slots whose points changed
  uint gone;            // points that were taken away
  uvec3 moveGroups;     // one invocation a move
  uvec3 movedGroups;    // one subgroup a move
  uvec3 applyGroups;    // one subgroup a touched bucket
  uvec3 changedGroups;  // one subgroup a changed point; never none
  uint finished;        // workgroups of a pass that are done with it

  uint head;        // first slot that no bucket has
  uint points;      // that are there
  uint compacting;  // not 0: buckets that change are noted
  uint dirty;       // buckets noted
  // Of the surface under a brush, MeasuredPoint of shaders/shared/brush.h: sums over all edits, which may run over.
  uint weights;
  uint normals[3];
  uint heights;
};
const uint kUpdateBytes = 124;
PALPATE_SIZE(HashUpdate, kUpdateBytes);
const uint kUpdateBegins = 88;  // bytes of the first part

struct HashUpdateArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(PointMoves) moves;
  PALPATE_ADDRESS(Uints) marks;       // one a bucket
  PALPATE_ADDRESS(Uints) touched;     // buckets whose points change, 2 mostMoves; then two words a move
  PALPATE_ADDRESS(Uints) movesOf;     // one a slot: the move of its point, where that move names the slot
  PALPATE_ADDRESS(Uints) capacities;  // one a bucket; 0: as many as it has points
  PALPATE_ADDRESS(Uints) changed;     // slots
  PALPATE_ADDRESS(DirtyBuckets) dirty;
  uint mostMoves;
  uint unused;
};
PALPATE_SIZE(HashUpdateArgs, 128);

// After a full build: what is in which slots, found anew.
struct HashRecountArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(Uints) changed;
};
PALPATE_SIZE(HashRecountArgs, 72);

PALPATE_SHARED_END
#endif
