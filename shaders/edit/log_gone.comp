#version 460
#extension GL_GOOGLE_include_directive : require
// Between the batches of an edit that reaches more points than the list of moves holds: the next batch takes that list,
// which alone knows the points that this one has taken away.
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
