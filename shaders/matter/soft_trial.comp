#version 460
#extension GL_GOOGLE_include_directive : require
// Nodes of a soft body displaced by a small step along a search direction, with zero velocity.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_descent.h"

layout(push_constant, scalar) uniform Push { SoftDescentArgs args; };

#include "shaders/lib/soft_descent.glsl"

void main() {
  const uint node = threadIndex();
  const float scale = args.sign * trialScale();
  if (node >= args.nodeCount) return;
  const vec4 moved = args.nodes.at[kNodeVec4s * node];
  const vec3 way = args.vectors.at[at(kWayVector, node)].xyz;
  args.trial.at[kNodeVec4s * node] = vec4(moved.xyz + scale * way, moved.w);
  args.trial.at[kNodeVec4s * node + 1] = vec4(0, 0, 0, args.nodes.at[kNodeVec4s * node + 1].w);
}
