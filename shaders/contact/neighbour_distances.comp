#version 460
#extension GL_GOOGLE_include_directive : require
// Sum of the distances of each examined point to its nearest neighbours, within a radius that is doubled where it holds
// too few. One invocation for each slot: in hash order those of a subgroup visit the same cells.
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#include "shaders/lib/index.glsl"
#include "shaders/shared/neighbour_distances.h"
#include "shaders/lib/nearest_list.glsl"

layout(push_constant, scalar) uniform Push { NeighbourDistancesArgs args; };

NearestList nearestWithin(uint slot, vec3 center, float radius, inout uint work) {
  const ivec3 low = cellOf(args.cloud.grid, center - radius);
  const ivec3 high = cellOf(args.cloud.grid, center + radius);
  NearestList list;
  list.count = 0;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x && work < kDistanceWorkBudget; ++x) {
        const ivec3 cell = ivec3(x, y, z);
        const uvec2 range = args.cloud.ranges.at[bucketOf(args.cloud.grid, cell)];
        const uint end = min(range.y, range.x + kDistanceWorkBudget - work);
        work += 1 + end - range.x;
        for (uint j = range.x; j < end; ++j) {
          const vec3 position = args.cloud.positions.at[j].xyz;
          const vec3 d = position - center;
          const float squared = dot(d, d);
          if (j == slot || squared >= radius * radius || cellOf(args.cloud.grid, position) != cell) continue;
          keepNearest(list, args.neighbours, squared, position, center);
        }
      }
  return list;
}

void main() {
  const uint slot = threadIndex();
  if (slot >= args.cloud.slots) return;
  const vec4 point = args.cloud.positions.at[slot];
  const uint id = floatBitsToUint(point.w);
  if (id == kEmptySlot || args.distances.at[id].x != kExamined) return;
  uint work = 0;
  float radius = args.radius;
  NearestList list;
  for (uint pass = 0; pass < kDistancePasses; ++pass, radius *= 2) {
    list = nearestWithin(slot, point.xyz, radius, work);
    if (list.count == args.neighbours || work >= kDistanceWorkBudget) break;
  }
  if (work >= kDistanceWorkBudget || list.count < args.neighbours) {
    args.distances.at[id] = vec2(work >= kDistanceWorkBudget ? kCrowded : kSparse, 0);
    return;
  }
  vec2 sum = vec2(0);
  for (uint k = 0; k < list.count; ++k) sum = plus(sum, root(list.squared[k]));
  args.distances.at[id] = sum;
}
