#version 460
#extension GL_GOOGLE_include_directive : require
// The moves of one tick: what the brush reaches, in the cells of the tool's box or, where slots are fewer, in all of
// those, and what the wishes of the last tick come to. The first workgroups select, the others recall; the one that is done
// last gives new points their ids.
#include "shaders/lib/index.glsl"
#include "shaders/lib/births.glsl"
#include "shaders/lib/edit_end.glsl"
#include "shaders/lib/recall_wishes.glsl"
#include "shaders/lib/select_moves.glsl"

layout(push_constant, scalar) uniform Push { CollectArgs args; };

void select(uint group) {
  if (tool.acts == 0) return;
  if (args.cells == 0)
    selectFromSlots(args, group * gl_WorkGroupSize.x + gl_LocalInvocationIndex);
  else
    selectFromCells(args, group * kSelectCells);
}

// Done with the wishes, which nobody reads any more. One workgroup.
void dropWishes(ResampleLists lists) {
  dropClaims(lists, args.tables.at[0].mostMoves, brush.support, gl_LocalInvocationIndex, gl_WorkGroupSize.x);
  barrier();
  if (gl_LocalInvocationIndex != 0) return;
  lists.now.births = 0;
  lists.now.wishes = 0;
}

void main() {
  if (args.recalls == kForgetsWishes)
    brush = args.brush.at[0];
  else
    takeUpBrush(args.brush, args.state);
  const uint selecting = selectGroups(args.cells, args.slots), group = workgroupIndex();
  if (group < selecting) select(group);
  if (args.recalls == kRecallsNothing) return;
  ResampleLists lists = args.tables.at[0].lists;
  const uint recalling = gl_NumWorkGroups.x * gl_NumWorkGroups.y - selecting;
  if (group >= selecting)
    recallWishes(args, lists, (group - selecting) * gl_NumSubgroups + gl_SubgroupID, recalling * gl_NumSubgroups);
  if (!finishesLast(args.update)) return;
  if (args.recalls == kRecallsWishes)
    bearPoints(args, lists);
  else
    dropWishes(lists);
  if (gl_LocalInvocationIndex == 0) args.update.at[0].finished = 0;
}
