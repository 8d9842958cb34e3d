#pragma once

#include <memory>

#include "engine/gpu/command_list.hpp"
#include "shaders/shared/radix_sort.h"

namespace palpate {

/// A stable sort of (key, value) pairs of 32 bits each by the low bits of the key. The result is deterministic and the
/// same for all implementations.
class PairSort {
 public:
  struct Io {
    DeviceAddress keys, values;        ///< `count` uint32 each; input, overwritten
    DeviceAddress keysAlt, valuesAlt;  ///< of the same size
    const Buffer& scratch;             ///< scratchBytes(count)
  };
  struct Sorted {
    DeviceAddress keys, values;  ///< the one of the two pairs that holds the result
  };

  virtual ~PairSort() = default;
  virtual std::uint64_t scratchBytes(std::uint64_t count) const = 0;
  virtual Sorted record(CommandList& list, const Io& io, std::uint32_t count) const = 0;
};

/// One digit of a radix sort: the bits [shift, shift + bits) of the key.
struct RadixDigit {
  std::uint32_t shift, bits;
};
/// The digits of `keyBits` (0 to 32), least significant first, at most `mostBits` each and as even as possible: 20 bits
/// make 7 + 7 + 6.
std::vector<RadixDigit> radixDigits(std::uint32_t keyBits, std::uint32_t mostBits = shared::kSortMaxDigitBits);

}  // namespace palpate
