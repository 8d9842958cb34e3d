#version 460
#extension GL_GOOGLE_include_directive : require
// Positions of the points that a soft body carries: they move with the nodes of their cell, by their share of each.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_passes.h"

layout(push_constant, scalar) uniform Push { SoftCarryArgs args; };

void main() {
  const uint id = threadIndex();
  if (id >= args.points) return;
  const vec4 rest = args.rests.at[id], share = args.shares.at[id];
  const vec2 normalRest = uintBitsToFloat(args.normalRests.at[id]);
  const uvec4 corners = args.corners.at[floatBitsToUint(rest.w)];
  vec3 moved = vec3(0), velocity = vec3(0);
  mat3 change = mat3(0);
  for (uint k = 0; k < 8; ++k) {
    const uint node = corners[k / 2] + k % 2;
    const float part = cornerShare(share.xyz, int(k));
    moved += part * args.nodes.at[kNodeVec4s * node].xyz;
    velocity += part * args.nodes.at[kNodeVec4s * node + 1].xyz;
    for (uint column = 0; column < 3; ++column)
      change[column] += part * args.nodeGradients.at[kGradientVec4s * node + column].xyz;
  }
  const vec3 normal = unitNormalCarried(change, vec3(share.w, normalRest));
  args.positions.at[id] = vec4(args.unitsPerMetre * (rest.xyz + moved) - args.origin, uintBitsToFloat(id));
  args.normals.at[id] = vec4(normal, 0);
  args.velocities.at[id] = vec4(args.setting.now.carriedSpeed * args.unitsPerMetre * velocity, 0);
}
