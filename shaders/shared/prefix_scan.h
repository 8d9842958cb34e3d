#ifndef PALPATE_SHARED_PREFIX_SCAN_H
#define PALPATE_SHARED_PREFIX_SCAN_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// Consecutive values that one invocation scans alone. More give fewer tiles; too many spill registers.
const uint kScanItems = 8;
const uint kScanWorkgroup = 256;
const uint kScanTile = kScanWorkgroup * kScanItems;  // values that one workgroup scans

struct PrefixScanArgs {
  PALPATE_ADDRESS(Uints) values;    // in and out: `count` values
  PALPATE_ADDRESS(Uints) tileSums;  // one per tile
  uint count;
  uint tiles;
};
PALPATE_SIZE(PrefixScanArgs, 24);

// Counts to ranges: the same scan, with its result written as (first, one past last).
struct BucketRangesArgs {
  PALPATE_ADDRESS(Uints) counts;    // `count` values; zeroed
  PALPATE_ADDRESS(Uints) tileSums;  // one per tile
  PALPATE_ADDRESS(UVec2s) ranges;
  uint count;
  uint tiles;
};
PALPATE_SIZE(BucketRangesArgs, 32);

PALPATE_SHARED_END
#endif
