// Cells and buckets of the spatial hash. engine/spatial/hash_grid.hpp computes the same bits on the CPU.
#ifndef PALPATE_LIB_HASH_GRID_GLSL
#define PALPATE_LIB_HASH_GRID_GLSL
#include "shaders/shared/spatial_hash.h"

ivec3 cellOf(HashGrid grid, vec3 position) {
  precise vec3 scaled = (position - grid.origin) * grid.inverseCell;
  return ivec3(clamp(floor(scaled), -kMaxCellCoordinate, kMaxCellCoordinate));
}

// Teschner et al. 2003, section 4.1.
uint bucketOf(HashGrid grid, ivec3 cell) {
  const uvec3 c = uvec3(cell);
  return ((c.x * 73856093u) ^ (c.y * 19349663u) ^ (c.z * 83492791u)) & grid.bucketMask;
}

#endif
