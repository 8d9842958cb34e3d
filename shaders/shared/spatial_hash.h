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

// A bucket with more points than this is called crowded, and the next build sorts by radix: ranking costs the square of
// the points in a bucket.
const uint kCrowdedBucket = 512;
// Points of a larger bucket are left in the order of their arrival. Above kCrowdedBucket, so that hardly an edit gets
// there before the sort has changed. Each point looks at all of its bucket, and validation on the GPU searches every
// buffer at each look: a larger bucket would take it past the 65,535 rounds after which one software driver stops a
// shader, and it would call good addresses bad.
const uint kMostRanked = 1024;

struct HashCountArgs {
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Uints) keys;      // out: the bucket of every point
  PALPATE_ADDRESS(Uints) arrivals;  // out: points of the same bucket that were counted before
  PALPATE_ADDRESS(Uints) counts;    // one per bucket, zero before
  HashGrid grid;
  uint count;
  uint unused;
};
PALPATE_SIZE(HashCountArgs, 64);

struct HashPlaceArgs {
  PALPATE_ADDRESS(Uints) keys;
  PALPATE_ADDRESS(Uints) arrivals;
  PALPATE_ADDRESS(UVec2s) ranges;
  PALPATE_ADDRESS(Uints) order;  // out
  uint count;
  uint unused;
};
PALPATE_SIZE(HashPlaceArgs, 40);

struct HashScatterArgs {
  PALPATE_ADDRESS(Uints) keys;
  PALPATE_ADDRESS(Uints) arrivals;
  PALPATE_ADDRESS(UVec2s) ranges;
  PALPATE_ADDRESS(Vec4s) positionsIn;
  PALPATE_ADDRESS(Vec4s) normalsIn;
  PALPATE_ADDRESS(Vec4s) positionsOut;
  PALPATE_ADDRESS(Vec4s) normalsOut;
  uint count;
  uint unused;
};
PALPATE_SIZE(HashScatterArgs, 64);

struct HashSettleArgs {
  PALPATE_ADDRESS(Uints) keys;
  PALPATE_ADDRESS(Uints) order;
  PALPATE_ADDRESS(UVec2s) ranges;
  PALPATE_ADDRESS(Vec4s) positionsIn;
  PALPATE_ADDRESS(Vec4s) normalsIn;
  PALPATE_ADDRESS(Vec4s) positionsOut;
  PALPATE_ADDRESS(Vec4s) normalsOut;
  PALPATE_ADDRESS(Uints) crowded;  // host-read: points of a crowded bucket; untouched where there is none
  uint count;
  uint unused;
};
PALPATE_SIZE(HashSettleArgs, 72);

PALPATE_SHARED_END
#endif
