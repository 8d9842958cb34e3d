#version 460
#extension GL_GOOGLE_include_directive : require
// The moves of one tick: those of points in reach of the brush, in the cells of the brush's box or, if there are fewer
// slots, in all slots, and those that the requests of the last tick become. The first workgroups select, the others
// recall.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"

layout(push_constant, scalar) uniform Push { CollectArgs args; };
#include "shaders/lib/births.glsl"
#include "shaders/lib/recall_requests.glsl"
#include "shaders/lib/select_moves.glsl"

// Number of `count` elements for a worker that takes every `stride`-th from `first` on.
uint shareOf(uint count, uint first, uint stride) { return count > first ? (count - first + stride - 1) / stride : 0; }

void main() {
  if (args.recalls == kForgetsRequests)
    brush = args.brush.at[0];
  else
    takeUpBrush(args.brush, args.tool);
  const uint selecting = selectGroups(args.cells, args.slots), group = workgroupIndex();
  const bool selects = group < selecting;
  if (!selects && args.recalls == kRecallsNothing) return;
  UpdateLists update = updateLists();
  ResampleLists lists = args.tables.at[0].lists;
  // Of the subgroups that recall: the index of this one, and their number.
  const uint subgroup = (group - selecting) * gl_NumSubgroups + gl_SubgroupID;
  const uint subgroups = (gl_NumWorkGroups.x * gl_NumWorkGroups.y - selecting) * gl_NumSubgroups;
  if (!selects && args.recalls == kForgetsRequests) {
    forgetRequests(update, lists, subgroup, subgroups);
    if (subgroup == 0 && subgroupElect()) lists.now.births = 0;
    return;
  }
  if (selects) {
    const uint points = slotsToLookAt(group, selecting);
    for (uint base = 0; base < points; base += gl_WorkGroupSize.x) {
      const uint k = base + scanIndex();
      bool moves = false, reached = false, blocked = false;
      PointMove move;
      vec4 position = vec4(0.0), normal = vec4(0.0);
      FoundPoint found = FoundPoint(vec3(0.0), vec3(0.0), 0.0, 0.0);
      if (k < points) {
        uint cell;
        const uint slot = slotToLookAt(k, group, selecting, cell);
        position = args.cloud.positions.at[slot];
        normal = args.cloud.normals.at[slot];  // of all of them: a later load would be a second wait
        const uint id = floatBitsToUint(position.w);
        reached = isInReach(id, position.xyz) && standsIn(cell, position.xyz);
        if (reached) {
          found = foundPoint(id, position.xyz, normal.xyz);
          moves = brushedMove(slot, position, normal, found, move);
          const bool free = !isLocked(args.tables, id);
          blocked = free && isBlocked(position, normal, found);
          if (free && mayBlock(brush, found)) noteBlocked(id);
          reached = isSampled(id, tool.sampling);
        }
        if (moves) noteReached(id, position.xyz, found);
      }
      measure(reached, position.xyz, found);
      countBlocked(blocked);
      const uint at = nextMove(args.update, moves);
      if (moves) writeMove(update, at, move);
    }
    return;
  }
  const uint recalls = shareOf(requestsOf(update, lists), subgroup, subgroups);
  const uint births = shareOf((birthsOf(lists) + gl_SubgroupSize - 1) / gl_SubgroupSize, subgroup, subgroups);
  // Single call site for listing moves: shader compilers inline every call.
  for (uint step = 0; step < recalls + births; ++step) {
    bool moves = false;
    PointMove move;
    if (step < recalls) {
      const uint slot = requestingSlot(lists, subgroup + step * subgroups);
      if (slot != kEmptySlot) {
        const vec4 position = args.cloud.positions.at[slot];
        const vec4 normal = args.cloud.normals.at[slot];
        const uint id = floatBitsToUint(position.w);
        const bool brushed = isInReach(id, position.xyz) &&
                             brushedMove(slot, position, normal, foundPoint(id, position.xyz, normal.xyz), move);
        moves = recalled(slot, position, normal, brushed, move);
      }
    } else {
      const uint first = (subgroup + (step - recalls) * subgroups) * gl_SubgroupSize;
      moves = isBorn(lists, first + gl_SubgroupInvocationID, move);
    }
    const uint at = nextMove(args.update, moves);
    if (moves) writeMove(update, at, move);
  }
}
