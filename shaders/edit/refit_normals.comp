#version 460
#extension GL_GOOGLE_include_directive : require
// After points have moved and the hash is built anew: the normal of every moved point becomes the direction of least
// spread of its neighbours (Hoppe et al. 1992, section 3.2), on the side of its old normal, and the move goes to the log.
#include "shaders/lib/contact_buffers.glsl"
#include "shaders/lib/eigen.glsl"
#include "shaders/lib/hash_grid.glsl"
#include "shaders/lib/index.glsl"
#include "shaders/lib/weight.glsl"
#include "shaders/shared/edit.h"

layout(push_constant, scalar) uniform Push { RefitNormalsArgs args; };

vec3 fittedNormal(vec3 center, vec3 old) {
  const ivec3 low = cellOf(args.cloud.grid, center - args.radius);
  const ivec3 high = cellOf(args.cloud.grid, center + args.radius);
  float weights = 0.0;
  vec3 mean = vec3(0.0);
  mat3 moment = mat3(0.0);
  uint neighbours = 0;
  uint work = 0;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const ivec3 cell = ivec3(x, y, z);
        const uvec2 range = args.cloud.ranges.at[bucketOf(args.cloud.grid, cell)];
        ++work;
        for (uint j = range.x; j < range.y && work < kRefitWorkBudget; ++j, ++work) {
          const vec3 position = args.cloud.positions.at[j].xyz;
          const vec3 d = position - center;
          const float squared = dot(d, d);
          if (squared >= args.radius * args.radius || cellOf(args.cloud.grid, position) != cell) continue;
          const float w = wendland(sqrt(squared) / args.radius);
          weights += w;
          mean += w * d;
          moment += w * outerProduct(d, d);
          ++neighbours;
        }
      }
  if (neighbours < kMinNeighbours || weights <= 0.0) return old;
  mean /= weights;
  const vec3 normal = smallestEigenvector(moment / weights - outerProduct(mean, mean));
  if (dot(normal, normal) < 0.5) return old;
  return dot(normal, old) < 0.0 ? -normal : normal;
}

void main() {
  const uint i = threadIndex();
  if (i >= args.cloud.count) return;
  const vec4 old = args.cloud.normals.at[i];
  if (old.w == 0.0) return;
  const vec4 position = args.cloud.positions.at[i];
  const vec3 normal = fittedNormal(position.xyz, old.xyz);
  args.cloud.normals.at[i] = vec4(normal, 0.0);
  const uint slot = atomicAdd(args.head.at[0], 1) & args.capacityMask;
  args.entries.at[slot].position = position.xyz;
  args.entries.at[slot].id = floatBitsToUint(position.w);
  args.entries.at[slot].normal = normal;
  args.entries.at[slot].unused = 0;
}
