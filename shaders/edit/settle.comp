#version 460
#extension GL_GOOGLE_include_directive : require
// The fitted normals of the changed points go into the cloud.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"

layout(push_constant, scalar) uniform Push { SettleArgs args; };

void main() {
  if (args.update.at[0].failed != 0) return;
  const uint changed = args.update.at[0].changed;
  for (uint which = threadIndex(); which < changed; which += gl_NumWorkGroups.x * gl_WorkGroupSize.x)
    args.cloud.normals.at[args.changed.at[which]] = args.fitted.at[which];
}
