#version 460
#extension GL_GOOGLE_include_directive : require
// After points have moved and the hash is built anew: the normal of every moved point becomes the direction of least
// spread of its neighbours (Hoppe et al. 1992, section 3.2), on the side of its old normal, and the move goes to the
// log. One subgroup for each point.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/eigen.glsl"
#include "shaders/shared/spatial_hash.h"
#include "shaders/lib/index.glsl"
#include "shaders/lib/weight.glsl"
#include "shaders/shared/edit.h"

layout(push_constant, scalar) uniform Push { RefitNormalsArgs args; };

// Weighted moments of the neighbours about a place, summed over the subgroup.
struct Moments {
  float weight;
  uint neighbours;
  vec3 mean;       // sum of w d
  vec3 diagonal;   // sums of w dx dx, w dy dy, w dz dz
  vec3 mixed;      // sums of w dx dy, w dy dz, w dz dx
};

Moments momentsAbout(vec3 center) {
  const ivec3 low = cellOf(args.cloud.grid, center - args.radius);
  const ivec3 high = cellOf(args.cloud.grid, center + args.radius);
  Moments m = Moments(0.0, 0, vec3(0.0), vec3(0.0), vec3(0.0));
  uint work = 0;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const ivec3 cell = ivec3(x, y, z);
        const uvec2 range = args.cloud.ranges.at[bucketOf(args.cloud.grid, cell)];
        ++work;
        for (uint j = range.x + gl_SubgroupInvocationID; j < range.y && work < kRefitWorkBudget;
             j += gl_SubgroupSize, ++work) {
          const vec3 position = args.cloud.positions.at[j].xyz;
          const vec3 d = position - center;
          const float squared = dot(d, d);
          if (squared >= args.radius * args.radius || cellOf(args.cloud.grid, position) != cell) continue;
          const float w = wendland(sqrt(squared) / args.radius);
          m.weight += w;
          m.neighbours += 1;
          m.mean += w * d;
          m.diagonal += w * d * d;
          m.mixed += w * d * d.yzx;
        }
      }
  return Moments(subgroupAdd(m.weight), subgroupAdd(m.neighbours), subgroupAdd(m.mean), subgroupAdd(m.diagonal),
                 subgroupAdd(m.mixed));
}

vec3 fittedNormal(vec3 center, vec3 old) {
  const Moments m = momentsAbout(center);
  if (m.neighbours < kMinNeighbours || m.weight <= 0.0) return old;
  const vec3 mean = m.mean / m.weight;
  const vec3 diagonal = m.diagonal / m.weight - mean * mean;
  const vec3 mixed = m.mixed / m.weight - mean * mean.yzx;
  const vec3 normal = smallestEigenvector(mat3(diagonal.x, mixed.x, mixed.z,  //
                                               mixed.x, diagonal.y, mixed.y,  //
                                               mixed.z, mixed.y, diagonal.z));
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
