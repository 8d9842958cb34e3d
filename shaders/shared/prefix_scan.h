#ifndef PALPATE_SHARED_PREFIX_SCAN_H
#define PALPATE_SHARED_PREFIX_SCAN_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// Consecutive values that one invocation scans by itself. More means fewer tiles; too many spill registers.
const uint kScanItems = 8;

struct PrefixScanArgs {
  PALPATE_ADDRESS(Uints) values;    // in and out: `count` values
  PALPATE_ADDRESS(Uints) tileSums;  // one per tile
  uint count;
  uint tiles;
};
PALPATE_SIZE(PrefixScanArgs, 24);

PALPATE_SHARED_END
#endif
