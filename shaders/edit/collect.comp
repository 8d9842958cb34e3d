#version 460
#extension GL_GOOGLE_include_directive : require
// The moves of one tick: what the brush reaches, in the cells of the tool's box or, where slots are fewer, in all of
// those, and what the wishes of the last tick come to. The first workgroups select, the others recall.
#include "shaders/lib/index.glsl"
#include "shaders/lib/births.glsl"
#include "shaders/lib/recall_wishes.glsl"
#include "shaders/lib/select_moves.glsl"

layout(push_constant, scalar) uniform Push { CollectArgs args; };

void select(UpdateLists update, uint group, uint groups) {
  if (tool.acts == 0) return;
  if (args.cells == 0)
    selectFromSlots(args, update, group * gl_WorkGroupSize.x + gl_LocalInvocationIndex);
  else
    selectFromCells(args, update, group, groups);
}

void main() {
  if (args.recalls == kForgetsWishes)
    brush = args.brush.at[0];
  else
    takeUpBrush(args.brush, args.state);
  const uint selecting = selectGroups(args.cells, args.slots), group = workgroupIndex();
  UpdateLists update = listsOf(args.update, args.capacities, args.tables);
  if (group < selecting) select(update, group, selecting);
  if (args.recalls == kRecallsNothing || group < selecting) return;
  ResampleLists lists = args.tables.at[0].lists;
  const uint subgroups = (gl_NumWorkGroups.x * gl_NumWorkGroups.y - selecting) * gl_NumSubgroups;
  const uint subgroup = (group - selecting) * gl_NumSubgroups + gl_SubgroupID;
  recallWishes(args, update, lists, subgroup, subgroups);
  if (args.recalls == kRecallsWishes)
    bearPoints(args, update, lists, subgroup, subgroups);
  else if (subgroup == 0 && subgroupElect())
    lists.now.births = 0;
}
