#version 460
#extension GL_GOOGLE_include_directive : require
// After points have moved and the index follows: the normal of every moved point becomes the direction of least spread
// of its neighbours (Hoppe et al. 1992, section 3.2), on the side of its old normal, and the point goes to the log as
// it is now. One subgroup for each point.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"
#include "shaders/lib/neighbours.glsl"
#include "shaders/lib/plane_fit.glsl"

layout(push_constant, scalar) uniform Push { RefitNormalsArgs args; };

Moments moments;  // what this invocation has seen

void visitNeighbour(uint slot, vec4 position, vec3 d) {
  addNeighbour(moments, d, args.radius);
}

Moments momentsAbout(vec3 center) {
  moments = noMoments();
  visitNeighbours(args.cloud, center, args.radius);
  return Moments(subgroupAdd(moments.weight), subgroupAdd(moments.neighbours), subgroupAdd(moments.mean),
                 subgroupAdd(moments.diagonal), subgroupAdd(moments.mixed));
}

vec3 fittedNormal(vec3 center, vec3 old) {
  const vec3 normal = planeNormal(momentsAbout(center));
  if (dot(normal, normal) < 0.5) return old;
  return dot(normal, old) < 0.0 ? -normal : normal;
}

void main() {
  const uint changed = args.update.at[0].changed;
  const uint stride = gl_NumWorkGroups.x * gl_NumSubgroups;
  for (uint which = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID; which < changed; which += stride) {
    const uint i = args.changed.at[which];
    const vec4 position = args.cloud.positions.at[i];
    const vec4 before = args.cloud.normals.at[i];
    vec3 normal = before.xyz;
    if (before.w == kMarkRefit) normal = fittedNormal(position.xyz, normal);
    if (subgroupElect()) {
      const uint id = floatBitsToUint(position.w);
      args.cloud.normals.at[i] = vec4(normal, 0.0);
      const uint slot = atomicAdd(args.head.at[0], 1) & args.capacityMask;
      args.entries.at[slot].position = position.xyz;
      args.entries.at[slot].id = id;
      args.entries.at[slot].normal = normal;
      args.entries.at[slot].color = colorOf(args.colors, id);
      args.entries.at[slot].parent = parentOf(args.parents, args.firstNew, id);
    }
  }
}
