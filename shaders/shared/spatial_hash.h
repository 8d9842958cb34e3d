#ifndef PALPATE_SHARED_SPATIAL_HASH_H
#define PALPATE_SHARED_SPATIAL_HASH_H
#include "shaders/shared/hash_grid.h"

PALPATE_SHARED_BEGIN

// The id in a slot without a point. A build puts empty slots into a separate bucket after all others, at the end of the
// slots.
const uint kEmptySlot = 0xffffffffu;

// A cloud in hash order with its index, as queries read it. The points of a bucket are in consecutive slots.
struct CloudView {
  PALPATE_ADDRESS(Vec4s) positions;  // xyz: model units; w: bits of the point's id, or of kEmptySlot
  PALPATE_ADDRESS(Vec4s) normals;    // xyz: unit; w: 0, or a kMark... of shaders/shared/hash_update.h during an edit
  PALPATE_ADDRESS(UVec2s)
  ranges;  // first and one-past-last slot of every bucket; the last range is that of the empty slots
  HashGrid grid;
  uint slots;
  uint unused;
};
PALPATE_SIZE(CloudView, 56);

// Points that an invocation loads at once on a walk over neighbours: more hide memory latency better and take more
// registers.
const uint kWalkedAtOnce = 4;

PALPATE_FUNCTION uint emptyBucket(HashGrid grid) { return grid.bucketMask + 1u; }
PALPATE_FUNCTION uint bucketOfSlot(HashGrid grid, vec4 position) {
  return floatBitsToUint(position.w) == kEmptySlot
             ? emptyBucket(grid)
             : bucketOf(grid, cellOf(grid, vec3(position.x, position.y, position.z)));
}

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

// A bucket with more points than this is crowded, and the next build sorts by radix: the cost of ranking is the square
// of the points in a bucket.
const uint kCrowdedBucket = 512;
// Points of a larger bucket stay in the order of their arrival. Above kCrowdedBucket, so that an edit rarely gets there
// before the sort has changed. More would, with validation on the GPU, which searches every buffer at each access,
// exceed the 65,535 iterations after which one software driver stops a shader, and report valid addresses as invalid.
const uint kMaxRanked = 1024;

struct HashCountArgs {
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Uints) keys;      // out: the bucket of every point
  PALPATE_ADDRESS(Uints) arrivals;  // out: points of the same bucket counted before this one
  PALPATE_ADDRESS(Uints) counts;    // one per bucket, initially zero
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
  PALPATE_ADDRESS(Uints) crowded;  // host-read: points of a crowded bucket; not written if there is none
  uint count;
  uint emptyBucket;
};
PALPATE_SIZE(HashSettleArgs, 72);

PALPATE_SHARED_END
#endif
