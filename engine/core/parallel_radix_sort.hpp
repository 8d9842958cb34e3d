// Sorting by integers of few bits, with many threads.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/core/bare_vector.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

/// Sorts by the lowest `bits` bits of keyOf(value), from the last digit to the first (Knuth 1998, "Sorting and
/// searching", section 5.2.5). Stable for any number of `threads` (0: one per core).
template <class T, class KeyOf>
void parallelRadixSort(BareVector<T>& values, unsigned bits, unsigned threads, KeyOf&& keyOf) {
  constexpr unsigned kDigitBits = 11;  // so that the counts stay in the fastest cache
  constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
  const ParallelRanges ranges(values.size(), threads);
  std::vector<std::array<std::size_t, kDigits>> next(ranges.count());  // counts, then the next index of each range
  BareVector<T> sorted(values.size());
  for (unsigned shift = 0; shift < bits; shift += kDigitBits) {
    const std::uint64_t digits = bits - shift < kDigitBits ? (1u << (bits - shift)) - 1 : kDigits - 1;
    const auto digitOf = [&](const T& value) { return static_cast<std::size_t>(keyOf(value) >> shift & digits); };
    parallelParts(ranges.count(), [&](std::size_t k) {
      next[k].fill(0);
      for (std::size_t i = ranges.begin(k); i < ranges.end(k); ++i) ++next[k][digitOf(values[i])];
    });
    std::size_t total = 0;
    for (std::size_t digit = 0; digit < kDigits; ++digit)
      for (auto& range : next) total += std::exchange(range[digit], total);
    parallelParts(ranges.count(), [&](std::size_t k) {
      std::array<std::size_t, kDigits> places = next[k];
      for (std::size_t i = ranges.begin(k); i < ranges.end(k); ++i) sorted[places[digitOf(values[i])]++] = values[i];
    });
    values.swap(sorted);
  }
}

/// The value at `rank` in sorted order. No value is NaN; -0 and 0 may stand for each other.
inline float parallelNth(std::span<const float> values, std::size_t rank, unsigned threads) {
  constexpr unsigned kDigitBits = 16;
  constexpr std::uint32_t kSign = 0x80000000;
  // Maps floats to integers of the same order.
  const auto keyOf = [](float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return bits & kSign ? ~bits : bits | kSign;
  };
  const ParallelRanges ranges(values.size(), threads);
  std::uint32_t found = 0;  // the digits found so far
  for (const unsigned shift : {kDigitBits, 0u}) {
    std::vector<std::vector<std::uint32_t>> counts(ranges.count());
    parallelParts(ranges.count(), [&](std::size_t k) {
      counts[k].assign(std::size_t{1} << kDigitBits, 0);
      for (std::size_t i = ranges.begin(k); i < ranges.end(k); ++i) {
        const std::uint64_t key = keyOf(values[i]);
        if (key >> (shift + kDigitBits) == std::uint64_t{found} >> (shift + kDigitBits))
          ++counts[k][key >> shift & 0xFFFF];
      }
    });
    for (std::uint32_t digit = 0;; ++digit) {
      std::size_t count = 0;
      for (const auto& range : counts) count += range[digit];
      if (rank < count) {
        found |= digit << shift;
        break;
      }
      rank -= count;
    }
  }
  return std::bit_cast<float>(found & kSign ? found & ~kSign : ~found);
}

}  // namespace palpate
