#ifndef PALPATE_SHARED_SPATIAL_HASH_H
#define PALPATE_SHARED_SPATIAL_HASH_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// Cell coordinates stay within this, so that a far outlier or a wild query cannot overflow an int.
const float kMaxCellCoordinate = 1073741824.0f;

// A regular grid without bounds whose cells are hashed into `bucketMask + 1` buckets (a power of two).
struct HashGrid {
  vec3 origin;        // corner of cell (0, 0, 0), model units
  float inverseCell;  // 1 / edge of a cell, 1 / model unit
  uint bucketMask;
};
PALPATE_SIZE(HashGrid, 20);

// A cloud in hash order with its index: what a query reads.
struct CloudView {
  PALPATE_ADDRESS(Vec4s) positions;  // xyz: model units; w: bits of the point's id
  PALPATE_ADDRESS(Vec4s) normals;    // xyz: unit; w: 1 while the point's normal waits to be refitted, else 0
  PALPATE_ADDRESS(UVec2s) ranges;    // first and one-past-last point of every bucket
  HashGrid grid;
  uint count;
};
PALPATE_SIZE(CloudView, 48);

struct HashKeysArgs {
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Uints) keys;
  PALPATE_ADDRESS(Uints) order;
  HashGrid grid;
  uint count;
};
PALPATE_SIZE(HashKeysArgs, 48);

struct HashReorderArgs {
  PALPATE_ADDRESS(Uints) sortedKeys;
  PALPATE_ADDRESS(Uints) sortedOrder;
  PALPATE_ADDRESS(Vec4s) positionsIn;
  PALPATE_ADDRESS(Vec4s) normalsIn;
  PALPATE_ADDRESS(Vec4s) positionsOut;
  PALPATE_ADDRESS(Vec4s) normalsOut;
  PALPATE_ADDRESS(UVec2s) ranges;
  uint count;
  uint unused;
};
PALPATE_SIZE(HashReorderArgs, 64);

PALPATE_SHARED_END
#endif
