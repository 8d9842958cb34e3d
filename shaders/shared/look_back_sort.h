#ifndef PALPATE_SHARED_LOOK_BACK_SORT_H
#define PALPATE_SHARED_LOOK_BACK_SORT_H
#include "shaders/shared/radix_sort.h"

#ifndef __cplusplus
// Read by other workgroups while this one runs. One word holds both state and count, so no order between words is
// needed.
layout(buffer_reference, scalar, buffer_reference_align = 4) volatile buffer TileWords { uint at[]; };
#endif

PALPATE_SHARED_BEGIN

const uint kSweepHistogramItems = 16;  // keys per invocation of the histogram; a multiple of 8
// A tile's word for one digit: its state in the top bits, a count in the others.
const uint kSweepCountBits = 30;
const uint kSweepOwn = 1u << kSweepCountBits;  // the count of the tile alone
const uint kSweepAll = 2u << kSweepCountBits;  // of the tile and all before it, from the digit's first position
const uint kSweepCountMask = kSweepOwn - 1u;

struct RadixHistogramArgs {
  PALPATE_ADDRESS(Uints) keys;
  PALPATE_ADDRESS(Uints) histograms;  // [pass][digit], zero before
  uint count;
  uint unused;
};
PALPATE_SIZE(RadixHistogramArgs, 24);

struct RadixSweepArgs {
  PALPATE_ADDRESS(Uints) keysIn;
  PALPATE_ADDRESS(Uints) valuesIn;
  PALPATE_ADDRESS(Uints) keysOut;
  PALPATE_ADDRESS(Uints) valuesOut;
  PALPATE_ADDRESS(Uints) histogram;  // [digit] of this pass
  PALPATE_ADDRESS(Uints) nextTile;   // one word, zero before
  PALPATE_ADDRESS(TileWords) tiles;  // [tile][digit], zero before
  uint count;
  uint shift;
};
PALPATE_SIZE(RadixSweepArgs, 64);

PALPATE_SHARED_END
#endif
