// Sorting by Morton codes, with many threads.
#pragma once

#include <bit>
#include <cstdint>
#include <functional>

#include "engine/cloud/morton.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/core/parallel_radix_sort.hpp"

namespace palpate {

/// Sorts by codeOf(value), a Morton code of 63 bits; stable for any number of `threads` (0: one per core). The first
/// bit of a coordinate gives the side of the middle that a cell is on. The bits below it are its complement, down to
/// those that distinguish the cells of the cloud; only these are sorted by.
template <class T, class CodeOf>
void sortByMorton(BareVector<T>& values, unsigned threads, CodeOf&& codeOf) {
  constexpr int kFirst = 3 * (kMortonBits - 1);
  constexpr std::uint64_t kBelow = (std::uint64_t{1} << kFirst) - 1;
  constexpr std::uint64_t kEachBelow = 0x1249249249249249 & kBelow;  // of one coordinate
  const auto telling = [&](std::size_t begin, std::size_t end) {
    std::uint64_t bits = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint64_t code = codeOf(values[i]);
      bits |= (code & kBelow) ^ kEachBelow * (7 ^ code >> kFirst);
    }
    return bits;
  };
  const std::uint64_t bits = parallelReduce(values.size(), threads, std::uint64_t{0}, telling, std::bit_or<>());
  const int kept = 3 * ((static_cast<int>(std::bit_width(bits)) + 2) / 3);
  parallelRadixSort(values, static_cast<unsigned>(kept + 3), threads, [&](const T& value) {
    const std::uint64_t code = codeOf(value);
    return code >> kFirst << kept | (code & ((std::uint64_t{1} << kept) - 1));
  });
}

}  // namespace palpate
