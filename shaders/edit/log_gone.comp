#version 460
#extension GL_GOOGLE_include_directive : require
// Between the batches of an edit that reaches more points than the list of moves holds: logs the points that this batch
// has removed, which only that list contains, before the next batch reuses it.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_end.glsl"

layout(push_constant, scalar) uniform Push { RefitNormalsArgs args; };
#include "shaders/lib/log_points.glsl"

void main() {
  const uint gone = args.update.at[0].gone;
  logGone(args.head.at[0]);
  if (!finishesLast(args.update) || gl_LocalInvocationIndex != 0) return;
  args.head.at[0] += gone;
  args.update.at[0].finished = 0;
}
