#ifndef PALPATE_SHARED_RADIX_SORT_H
#define PALPATE_SHARED_RADIX_SORT_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

const uint kSortMaxDigitBits = 8;  // digits of one pass; the histograms in shared memory grow with two to this power
const uint kSortRadix = 1 << kSortMaxDigitBits;
const uint kSortMaxPasses = 8;  // of digits with fewer bits, where shared memory is small
// Keys per invocation of the reduce-then-scan form. Fewer give more workgroups to hide latency, and more counts to
// scan; 8 is faster than 16 for a million keys on a large GPU and costs one byte of scratch a key.
const uint kSortItems = 8;

struct RadixSortArgs {
  PALPATE_ADDRESS(Uints) keysIn;
  PALPATE_ADDRESS(Uints) valuesIn;
  PALPATE_ADDRESS(Uints) keysOut;
  PALPATE_ADDRESS(Uints) valuesOut;
  PALPATE_ADDRESS(Uints) counts;  // [digit][partition]; after the scan, where that partition's keys of that digit go
  uint count;
  uint partitions;
  uint shift;
  uint digitBits;
};
PALPATE_SIZE(RadixSortArgs, 56);

PALPATE_SHARED_END
#endif
