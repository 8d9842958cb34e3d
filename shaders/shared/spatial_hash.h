#ifndef PALPATE_SHARED_SPATIAL_HASH_H
#define PALPATE_SHARED_SPATIAL_HASH_H
#include "shaders/shared/hash_grid.h"

PALPATE_SHARED_BEGIN

// A cloud in hash order with its index: what a query reads.
struct CloudView {
  PALPATE_ADDRESS(Vec4s) positions;  // xyz: model units; w: bits of the point's id
  PALPATE_ADDRESS(Vec4s) normals;    // xyz: unit; w: 1 while the point's normal waits to be refitted, else 0
  PALPATE_ADDRESS(UVec2s) ranges;    // first and one-past-last point of every bucket
  HashGrid grid;
  uint count;
  uint unused;
};
PALPATE_SIZE(CloudView, 56);

struct HashKeysArgs {
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Uints) keys;
  PALPATE_ADDRESS(Uints) order;
  HashGrid grid;
  uint count;
  uint unused;
};
PALPATE_SIZE(HashKeysArgs, 56);

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
