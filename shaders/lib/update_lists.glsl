// Lists the moves of an update of the index (shaders/shared/hash_update.h). Requires arguments with a cloud and an
// update.
#ifndef PALPATE_LIB_UPDATE_LISTS_GLSL
#define PALPATE_LIB_UPDATE_LISTS_GLSL

#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/lib/hash_update.glsl"

uint bucketAt(vec3 position) { return bucketOf(args.cloud.grid, cellOf(args.cloud.grid, position)); }

// Lists moves and the buckets that they concern. Addresses are plain words here: drivers crash if a struct with buffer
// references is copied.
struct UpdateLists {
  uvec2 moves, marks, touched, movesOf, capacities;
  uint mostMoves;
};

void listBucket(UpdateLists lists, uint bucket) {
  const uint at = atomicAdd(args.update.at[0].touched, 1);
  Uints(lists.touched).at[at] = bucket;
  if (kCountsGroups != 0) atomicMax(args.update.at[0].applyGroups.x, updateGroups(at + 1, gl_NumSubgroups));
}

// New slots for a bucket of `points` points at which `arrived` more have arrived, if the next one to arrive exceeds the
// bucket's slots, or those that it has just taken; kEmptySlot otherwise. `slots`: of the cloud.
uint roomFor(UpdateLists lists, uint bucket, uint slots, uint points, uint arrived) {
  const uint before = capacityFor(max(Uints(lists.capacities).at[bucket], points), points + arrived);
  if (before > points + arrived) return kEmptySlot;
  const uint wanted = capacityFor(before, points + arrived + 1);
  const uint room = args.update.at[0].head + atomicAdd(args.update.at[0].grown, wanted);
  if (room + wanted > slots) atomicOr(args.update.at[0].refused, kUpdateNoSlots);
  return room;
}

// Notes that move `at` brings a point to another bucket. Returns the bucket's mark before that.
uint arrive(UpdateLists lists, uint bucket, uint at) {
  const uvec2 range = args.cloud.ranges.at[bucket];
  uint before = 0;
  while (true) {
    if (arrivalsOf(before) == kMaxArrivals) {
      atomicOr(args.update.at[0].refused, kUpdateCrowded);
      return before;
    }
    const uint after = kMarkListed | ((before & ~kMarkMove) + kMarkArrival) | (at + 1);
    const uint found = atomicCompSwap(Uints(lists.marks).at[bucket], before, after);
    if (found == before) break;
    before = found;
  }
  PointMoves(lists.moves).at[at].before = before & kMarkMove;
  PointMoves(lists.moves).at[at].room = roomFor(lists, bucket, args.cloud.slots, range.y - range.x, arrivalsOf(before));
  return before;
}

// Notes that move `at` changes a point of one bucket, and brings it to another one; kNoBucket if there is none. The
// first invocation to mark a bucket lists it.
void touchBuckets(UpdateLists lists, uint from, uint to, uint at) {
  uint fromMark = kMarkListed, toMark = kMarkListed;
  if (from != kNoBucket) fromMark = atomicOr(Uints(lists.marks).at[from], kMarkListed);
  if (to != kNoBucket && to != from) toMark = arrive(lists, to, at);
  if ((fromMark & kMarkListed) == 0) listBucket(lists, from);
  if ((toMark & kMarkListed) == 0) listBucket(lists, to);
}

// Writes a move to the index from nextMove(), and touches the buckets that it concerns.
void writeMove(UpdateLists lists, uint at, PointMove move) {
  if (at >= lists.mostMoves) {
    atomicOr(args.update.at[0].failed, kUpdateTooLarge);
    return;
  }
  PointMoves(lists.moves).at[at] = move;
  if (move.slot != kEmptySlot) Uints(lists.movesOf).at[move.slot] = at;
  touchBuckets(lists, move.fromBucket, move.toBucket, at);
}

#endif
