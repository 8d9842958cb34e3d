#version 460
#extension GL_GOOGLE_include_directive : require
// The moves of one tick: what the brush reaches, in the cells of the brush's box or, where slots are fewer, in all of
// those, and what the requests of the last tick bring about. The first workgroups select, the others recall.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"

layout(push_constant, scalar) uniform Push { CollectArgs args; };
#include "shaders/lib/births.glsl"
#include "shaders/lib/recall_requests.glsl"
#include "shaders/lib/select_moves.glsl"

void select(UpdateLists update, uint group, uint groups) {
  if (ball.acts == 0) return;
  if (args.cells == 0)
    selectFromSlots(update, group * gl_WorkGroupSize.x + gl_LocalInvocationIndex);
  else
    selectFromCells(update, group, groups);
}

void main() {
  if (args.recalls == kForgetsRequests)
    brush = args.brush.at[0];
  else
    takeUpBrush(args.brush, args.state);
  const uint selecting = selectGroups(args.cells, args.slots), group = workgroupIndex();
  UpdateLists update = updateLists();
  if (group < selecting) select(update, group, selecting);
  if (args.recalls == kRecallsNothing || group < selecting) return;
  ResampleLists lists = args.tables.at[0].lists;
  const uint subgroups = (gl_NumWorkGroups.x * gl_NumWorkGroups.y - selecting) * gl_NumSubgroups;
  const uint subgroup = (group - selecting) * gl_NumSubgroups + gl_SubgroupID;
  recallRequests(update, lists, subgroup, subgroups);
  if (args.recalls == kRecallsRequests)
    bearPoints(update, lists, subgroup, subgroups);
  else if (subgroup == 0 && subgroupElect())
    lists.now.births = 0;
}
