// The lists of an update (shaders/shared/hash_update.h) and how invocations append to them.
#ifndef PALPATE_LIB_HASH_UPDATE_GLSL
#define PALPATE_LIB_HASH_UPDATE_GLSL

#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require

layout(buffer_reference) coherent buffer HashUpdates;
layout(buffer_reference) buffer PointMoves;
layout(buffer_reference) buffer DirtyBuckets;
#include "shaders/shared/hash_update.h"
// The last workgroup of a pass reads what the others have counted.
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer HashUpdates { HashUpdate at[1]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PointMoves { PointMove at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer DirtyBuckets {
  uint capacity;  // buckets that the list holds
  uint words[];   // the map, then the list
};

// Not 0 where passes that follow are dispatched with as many groups as are counted here.
layout(constant_id = 1) const uint kCountsGroups = 1;

// Groups of `each` that hold so many.
uint updateGroups(uint count, uint each) { return min((count + each - 1) / each, kMostUpdateGroups); }

// Places at the end of the list of moves for every invocation of the subgroup that wants one; all of it call together.
uint nextMove(HashUpdates update, bool wants) {
  const uvec4 ballot = subgroupBallot(wants);
  const uint count = subgroupBallotBitCount(ballot);
  if (count == 0) return 0;
  uint first = 0;
  if (subgroupElect()) {
    first = atomicAdd(update.at[0].moves, count);
    if (kCountsGroups != 0) {
      atomicMax(update.at[0].moveGroups.x, updateGroups(first + count, kUpdateWorkgroup));
      atomicMax(update.at[0].movedGroups.x, updateGroups(first + count, gl_NumSubgroups));
    }
  }
  return subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(ballot);
}

// The same for the list of changed slots.
uint nextChanged(HashUpdates update, bool wants) {
  const uvec4 ballot = subgroupBallot(wants);
  const uint count = subgroupBallotBitCount(ballot);
  if (count == 0) return 0;
  uint first = 0;
  if (subgroupElect()) {
    first = atomicAdd(update.at[0].changed, count);
    if (kCountsGroups != 0) atomicMax(update.at[0].changedGroups.x, updateGroups(first + count, gl_NumSubgroups));
  }
  return subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(ballot);
}

// What lists moves and the buckets that they concern.
struct UpdateLists {
  HashUpdates update;
  PointMoves moves;
  Uints marks, touched, movesOf, capacities;
  uint mostMoves;
};

void listBucket(UpdateLists lists, uint bucket) {
  const uint at = atomicAdd(lists.update.at[0].touched, 1);
  lists.touched.at[at] = bucket;
  if (kCountsGroups != 0) atomicMax(lists.update.at[0].applyGroups.x, updateGroups(at + 1, gl_NumSubgroups));
}

// New slots for a bucket of so many points to which so many more have come, where the next one to come is the one that
// it outgrows its slots by, or those that it has just taken; kEmptySlot otherwise. `slots`: of the cloud.
uint roomFor(UpdateLists lists, uint bucket, uint slots, uint points, uint arrived) {
  const uint before = capacityFor(max(lists.capacities.at[bucket], points), points + arrived);
  if (before > points + arrived) return kEmptySlot;
  const uint wanted = capacityFor(before, points + arrived + 1);
  const uint room = lists.update.at[0].head + atomicAdd(lists.update.at[0].grown, wanted);
  if (room + wanted > slots) atomicOr(lists.update.at[0].refused, kUpdateNoSlots);
  return room;
}

// Says that move `at` brings a point to another bucket. Gives the bucket's mark before that.
uint arrive(CloudView cloud, UpdateLists lists, uint bucket, uint at) {
  const uvec2 range = cloud.ranges.at[bucket];
  uint before = 0;
  while (true) {
    if (arrivalsOf(before) == kMostArrivals) {
      atomicOr(lists.update.at[0].refused, kUpdateCrowded);
      return before;
    }
    const uint after = kMarkListed | ((before & ~kMarkMove) + kMarkArrival) | (at + 1);
    const uint found = atomicCompSwap(lists.marks.at[bucket], before, after);
    if (found == before) break;
    before = found;
  }
  lists.moves.at[at].before = before & kMarkMove;
  lists.moves.at[at].room = roomFor(lists, bucket, cloud.slots, range.y - range.x, arrivalsOf(before));
  return before;
}

// Says that move `at` changes a point of one bucket, and brings it to another one; kNoBucket where there is none.
// Whoever marks a bucket first lists it.
void touchBuckets(CloudView cloud, UpdateLists lists, uint from, uint to, uint at) {
  uint fromMark = kMarkListed, toMark = kMarkListed;
  if (from != kNoBucket) fromMark = atomicOr(lists.marks.at[from], kMarkListed);
  if (to != kNoBucket && to != from) toMark = arrive(cloud, lists, to, at);
  if ((fromMark & kMarkListed) == 0) listBucket(lists, from);
  if ((toMark & kMarkListed) == 0) listBucket(lists, to);
}

// Writes a move where nextMove() said, and touches the buckets that it concerns.
void writeMove(CloudView cloud, UpdateLists lists, uint at, PointMove move) {
  if (at >= lists.mostMoves) {
    atomicOr(lists.update.at[0].failed, kUpdateTooLarge);
    return;
  }
  lists.moves.at[at] = move;
  if (move.slot != kEmptySlot) lists.movesOf.at[move.slot] = at;
  touchBuckets(cloud, lists, move.fromBucket, move.toBucket, at);
}

#endif
