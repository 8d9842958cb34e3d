// Updates the index after an edit that touched k points, at a cost of k. A bucket's points are in consecutive slots, so
// that a query reads them as after a full build. A bucket that outgrows its slots moves as a whole to new ones at the
// end; its old slots stay empty until the next build or compaction.
#ifndef PALPATE_SHARED_HASH_UPDATE_H
#define PALPATE_SHARED_HASH_UPDATE_H
#include "shaders/shared/sheet_grid.h"
#include "shaders/shared/spatial_hash.h"

PALPATE_SHARED_BEGIN

const uint kNoBucket = 0xffffffffu;

// Written into the w of a normal by an edit, until the end of its tick.
const float kMarkRefit = 1.0f;  // the normal has to be refitted to its new neighbours
const float kMarkGiven = 2.0f;  // the point stays as it was given

// One change of a point, for the index.
struct PointMove {
  vec3 position;  // after the move, model units
  uint id;
  vec3 normal;
  float mark;       // kMark...
  uint slot;        // its present slot; kEmptySlot if it is new
  uint fromBucket;  // kNoBucket if it is new
  uint toBucket;    // kNoBucket if it is removed
  uint before;      // the move that arrived in toBucket before this one, counted from 1; 0: none
  uint room;        // first of the new slots of toBucket, if the arrival of this point exceeds its present ones, else
                    // kEmptySlot; for a removed point, its number among the removed ones
};
PALPATE_SIZE(PointMove, 52);

// The mark of a bucket from an edit's first pass to its update, 0 otherwise: a flag that it is listed, the number of
// arriving points, and the move that arrived last, counted from 1. That move links to the others (PointMove.before).
const uint kMarkListed = 0x80000000u;
const uint kMarkArrival = 0x00800000u;
const uint kMarkMove = kMarkArrival - 1u;  // maximum number of moves, too
PALPATE_FUNCTION uint arrivalsOf(uint mark) { return (mark & ~kMarkListed) / kMarkArrival; }

// Why an update was not carried out; the cloud is then unchanged.
const uint kUpdateTooLarge = 1;  // more moves than the list holds
const uint kUpdateNoSlots = 2;   // no slots left for a bucket to grow
const uint kUpdateCrowded = 4;   // too many points arrive in one bucket
const uint kUpdateUnknown = 8;   // a point is not where the edit says

// Workgroups in the first axis of an indirect dispatch; loops cover the remainder.
const uint kMaxUpdateGroups = 65535;
const uint kUpdateWorkgroup = 256;
// Points that may arrive in one bucket in one tick. They are ordered by comparing each with each.
const uint kMaxArrivals = 255;
// A bucket that moves gets room for half as many points again as it has then, and kSpareInBucket more.
const uint kSpareInBucket = 8;
PALPATE_FUNCTION uint roomToGrow(uint points) { return points + points / 2u + kSpareInBucket; }
// The capacity of a bucket that has held `capacity` points at most and is to hold `points`, which arrive one by one.
PALPATE_FUNCTION uint capacityFor(uint capacity, uint points) {
  while (capacity < points) capacity = roomToGrow(capacity + 1u);
  return capacity;
}

// Buckets that change during a compaction are noted once each: a bitmap marks them, and the list follows the bitmap.
PALPATE_FUNCTION uint dirtyListFrom(HashGrid grid) { return grid.bucketMask / 32u + 1u; }

// Counters of one update. The first kUpdateBegins bytes are zero between updates.
struct HashUpdate {
  uint moves;
  uint touched;
  uint arrivals;        // of buckets where more points arrive than a subgroup holds
  uint grown;           // slots that buckets take at the end
  uint refused;         // kUpdate...: an update is not carried out, but a full build may be
  uint wanted;          // slots that new points have taken before a full build
  uint failed;          // kUpdate...
  uint changed;         // slots whose points changed
  uint gone;            // points that were removed
  uvec3 moveGroups;     // one invocation for each move
  uvec3 movedGroups;    // one subgroup for each move
  uvec3 applyGroups;    // one subgroup for each touched bucket
  uvec3 changedGroups;  // one subgroup for each changed point; never zero
  uint finished;        // workgroups of a pass that have finished it

  uint head;        // first slot after those of all buckets
  uint points;      // present
  uint compacting;  // not 0: buckets that change are noted
  uint dirty;       // buckets noted
  // Of the surface under a brush, MeasuredPoint of shaders/shared/brush.h: sums over all edits, which may wrap around.
  uint weights;
  uint normals[3];
  uint heights;
  uint blocked;  // points that had no room for their step (shaders/shared/brush.h), likewise
  // The points that a brush has entered (shaders/shared/brush.h); cleared between updates.
  uint seen[kSheetWords];  // their cells
  uint nearest;            // smallest result of entered()
};
const uint kUpdateBytes = 644;
PALPATE_SIZE(HashUpdate, kUpdateBytes);
const uint kUpdateBegins = 88;  // bytes of the first part
const uint kUpdateSeen = 128;   // bytes before the cells

struct HashUpdateArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(PointMoves) moves;
  PALPATE_ADDRESS(Uints) marks;       // one for each bucket
  PALPATE_ADDRESS(Uints) touched;     // buckets whose points change, 2 mostMoves; then two words for each move
  PALPATE_ADDRESS(Uints) movesOf;     // one for each slot: the move of its point, if that move names the slot
  PALPATE_ADDRESS(Uints) capacities;  // one for each bucket; 0: its number of points
  PALPATE_ADDRESS(Uints) changed;     // slots
  PALPATE_ADDRESS(DirtyBuckets) dirty;
  uint mostMoves;
  uint unused;
};
PALPATE_SIZE(HashUpdateArgs, 128);

// After a full build: recounts which slots hold points.
struct HashRecountArgs {
  CloudView cloud;
  PALPATE_ADDRESS(HashUpdates) update;
  PALPATE_ADDRESS(Uints) changed;
};
PALPATE_SIZE(HashRecountArgs, 72);

PALPATE_SHARED_END
#endif
