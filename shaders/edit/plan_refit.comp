#version 460
#extension GL_GOOGLE_include_directive : require
// How many workgroups the refit of the collected points takes, over two axes where one is too short.
#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/index.glsl"
#include "shaders/shared/edit.h"

layout(push_constant, scalar) uniform Push { PlanRefitArgs args; };

void main() {
  if (threadIndex() != 0) return;
  const uint groups = (args.movedCount.at[0] + args.pointsPerGroup - 1) / args.pointsPerGroup;
  const uint rows = (groups + args.largestAxis - 1) / args.largestAxis;
  args.groups.at[0] = rows == 0 ? 0 : (groups + rows - 1) / rows;
  args.groups.at[1] = rows;
  args.groups.at[2] = 1;
}
