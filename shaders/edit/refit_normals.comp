#version 460
#extension GL_GOOGLE_include_directive : require
// After points have moved and the hash is built anew: the normal of every moved point becomes the direction of least
// spread of its neighbours (Hoppe et al. 1992, section 3.2), on the side of its old normal, and the move goes to the
// log. One subgroup for each point.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "shaders/lib/plane_fit.glsl"
#include "shaders/shared/spatial_hash.h"
#include "shaders/lib/index.glsl"
#include "shaders/shared/edit.h"

layout(push_constant, scalar) uniform Push { RefitNormalsArgs args; };

vec3 fittedNormal(vec3 center, vec3 old) {
  uint work = 0;
  const Share share = Share(gl_SubgroupInvocationID, gl_SubgroupSize);
  const Moments m = momentsAbout(args.cloud, center, args.radius, share, kRefitWorkBudget, work);
  const vec3 normal = planeNormal(Moments(subgroupAdd(m.weight), subgroupAdd(m.neighbours), subgroupAdd(m.mean),
                                          subgroupAdd(m.diagonal), subgroupAdd(m.mixed)));
  if (dot(normal, normal) < 0.5) return old;
  return dot(normal, old) < 0.0 ? -normal : normal;
}

void main() {
  const uint which = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID;
  if (which >= args.movedCount.at[0]) return;
  const uint i = args.moved.at[which];
  const vec4 position = args.cloud.positions.at[i];
  const vec3 normal = fittedNormal(position.xyz, args.cloud.normals.at[i].xyz);
  if (!subgroupElect()) return;
  args.cloud.normals.at[i] = vec4(normal, 0.0);
  const uint slot = atomicAdd(args.head.at[0], 1) & args.capacityMask;
  args.entries.at[slot].position = position.xyz;
  args.entries.at[slot].id = floatBitsToUint(position.w);
  args.entries.at[slot].normal = normal;
  args.entries.at[slot].color = 0;
  args.entries.at[slot].parent = floatBitsToUint(position.w);
}
