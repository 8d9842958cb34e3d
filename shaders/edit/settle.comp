#version 460
#extension GL_GOOGLE_include_directive : require
// Writes the fitted normals of the changed points to the cloud, publishes their log entries, and drops the requests of
// the last tick, unless the edit was not carried out.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_end.glsl"

layout(push_constant, scalar) uniform Push { SettleArgs args; };

void settle() {
  const uint changed = args.update.at[0].changed;
  for (uint which = threadIndex(); which < changed; which += gl_NumWorkGroups.x * gl_WorkGroupSize.x)
    args.cloud.normals.at[args.changed.at[which]] = vec4(args.fitted.at[which].xyz, 0.0);
  if (threadIndex() != 0) return;
  args.head.at[0] += changed + args.update.at[0].gone;
  if (!examines(args.lists)) return;
  args.lists.now.requests = 0;
  args.lists.now.nextId += args.lists.now.births;
  args.lists.now.births = 0;
  args.lists.now.tick += 1;
}

void main() {
  if (args.update.at[0].failed == 0) settle();
  if (!isNull(args.end.report) && finishesLast(args.update))
    endEdit(args.end.report, args.end.resampling, args.end.empty, args.update, args.lists);
}
