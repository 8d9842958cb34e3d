// The neighbours of a place, looked at by one subgroup.
#ifndef PALPATE_LIB_NEIGHBOURS_GLSL
#define PALPATE_LIB_NEIGHBOURS_GLSL

#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_shuffle : require

#include "shaders/shared/spatial_hash.h"

// Whoever includes this says what to do with a neighbour, which is `d` away. One invocation of the subgroup calls it.
void visitNeighbour(uint slot, vec4 position, vec3 d);

// Visits all points nearer than `radius` to `center`, each once. Each invocation looks up one cell, and then all share
// the points of those cells evenly. The whole subgroup calls it together. `budget`: rounds of its loops.
void visitNeighbours(CloudView cloud, vec3 center, float radius, uint budget) {
  const ivec3 low = cellOf(cloud.grid, center - radius);
  const uvec3 size = uvec3(cellOf(cloud.grid, center + radius) - low + 1);
  const uint cells = size.x * size.y * size.z;
  const uint lane = gl_SubgroupInvocationID;
  uint work = 0;
  for (uint firstCell = 0; firstCell < cells && work < budget; firstCell += gl_SubgroupSize) {
    const uint c = firstCell + lane;
    const ivec3 cell = low + ivec3(c % size.x, c / size.x % size.y, c / (size.x * size.y));
    uvec2 range = uvec2(0);
    if (c < cells) range = cloud.ranges.at[bucketOf(cloud.grid, cell)];
    const uint count = range.y - range.x;
    const uint start = subgroupExclusiveAdd(count);
    const uint total = subgroupAdd(count);
    ++work;
    for (uint base = 0; base < total && work < budget; base += gl_SubgroupSize) {
      const uint k = base + lane;
      uint owner = 0;  // the last lane whose points begin at or before k
      for (uint step = gl_SubgroupSize / 2; step > 0; step /= 2) {
        ++work;
        if (subgroupShuffle(start, owner + step) <= k) owner += step;
      }
      const uint slot = subgroupShuffle(range.x, owner) + k - subgroupShuffle(start, owner);
      const ivec3 itsCell = ivec3(subgroupShuffle(cell.x, owner), subgroupShuffle(cell.y, owner),
                                  subgroupShuffle(cell.z, owner));
      ++work;
      if (k < total) {
        const vec4 position = cloud.positions.at[slot];
        const vec3 d = position.xyz - center;
        // Another of these cells may share the bucket: its points are visited as that one's.
        if (dot(d, d) < radius * radius && cellOf(cloud.grid, position.xyz) == itsCell)
          visitNeighbour(slot, position, d);
      }
    }
  }
}

#endif
