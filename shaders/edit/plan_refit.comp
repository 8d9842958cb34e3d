#version 460
#extension GL_GOOGLE_include_directive : require
// How many workgroups the refit of the collected points takes, over two axes where one is too short.
#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/index.glsl"
#include "shaders/shared/edit.h"

layout(push_constant, scalar) uniform Push { PlanRefitArgs args; };

void main() {
  if (threadIndex() != 0) return;
  // Written so that no sum can overflow, however long an axis may be.
  const uint moved = args.movedCount.at[0];
  const uint groups = moved == 0 ? 0 : (moved - 1) / args.pointsPerGroup + 1;
  const uint rows = groups == 0 ? 0 : (groups - 1) / args.largestAxis + 1;
  args.groups.at[0] = rows == 0 ? 0 : (groups - 1) / rows + 1;
  args.groups.at[1] = rows;
  args.groups.at[2] = 1;
}
