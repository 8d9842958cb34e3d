#ifndef PALPATE_SHARED_HASH_GRID_H
#define PALPATE_SHARED_HASH_GRID_H
#include "shaders/shared/types.h"

#ifdef __cplusplus
#define precise
#endif

PALPATE_SHARED_BEGIN

// Cell coordinates are clamped to this, so that a far outlier or an extreme query cannot overflow an int.
const float kMaxCellCoordinate = 1073741824.0f;

// An unbounded regular grid whose cells are hashed into `bucketMask + 1` buckets (a power of two). Cells in a block of
// 2^blockBits a side keep their Morton order (Morton 1966), so that neighbours are near each other in memory; blocks
// are scattered by Teschner's hash. With blockBits 0 every cell is scattered, as in the thesis.
struct HashGrid {
  vec3 origin;        // corner of cell (0, 0, 0), model units
  float inverseCell;  // 1 / edge of a cell, 1 / model unit
  uint bucketMask;
  uint blockBits;  // 0 to 4
};
PALPATE_SIZE(HashGrid, 24);

// C++, GLSL and CUDA compute the same bits: nothing here can be contracted or reassociated.
PALPATE_FUNCTION ivec3 cellOf(HashGrid grid, vec3 position) {
  precise vec3 scaled = (position - grid.origin) * grid.inverseCell;
  return ivec3(clamp(floor(scaled), -kMaxCellCoordinate, kMaxCellCoordinate));
}

// Spreads the low four bits of `v`, three apart.
PALPATE_FUNCTION uint spreadBits(uint v) { return (v & 1u) | (v & 2u) << 2 | (v & 4u) << 4 | (v & 8u) << 6; }

// Teschner et al. 2003, section 4.1, for the cell's block; the cell's position in the block is in the low bits.
PALPATE_FUNCTION uint bucketOf(HashGrid grid, ivec3 cell) {
  const int bits = int(grid.blockBits);
  const uvec3 block = uvec3(cell.x >> bits, cell.y >> bits, cell.z >> bits);
  const uint inBlock = (1u << grid.blockBits) - 1u;
  const uvec3 c = uvec3(uint(cell.x) & inBlock, uint(cell.y) & inBlock, uint(cell.z) & inBlock);
  const uint scattered = (block.x * 73856093u) ^ (block.y * 19349663u) ^ (block.z * 83492791u);
  const uint ordered = spreadBits(c.x) | spreadBits(c.y) << 1 | spreadBits(c.z) << 2;
  return (scattered << (3u * grid.blockBits) | ordered) & grid.bucketMask;
}

PALPATE_SHARED_END

#ifdef __cplusplus
#undef precise
#endif
#endif
