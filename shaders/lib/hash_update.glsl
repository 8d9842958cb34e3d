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
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer PointMoves { PointMove at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer DirtyBuckets {
  uint capacity;  // buckets that the list holds
  uint words[];   // the map, then the list
};

// Not 0 if later passes are dispatched with the numbers of groups that are counted here.
layout(constant_id = 1) const uint kCountsGroups = 1;

// Groups of `each` that hold `count`.
uint updateGroups(uint count, uint each) { return min((count + each - 1) / each, kMaxUpdateGroups); }

// Indices at the end of the list of moves for every invocation of the subgroup that wants one; all of it call together.
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

#endif
