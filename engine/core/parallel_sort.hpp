// Sorting with many threads, for loading and for making clouds.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <vector>

#include "engine/core/parallel.hpp"

namespace palpate {

/// Sorts by operator<, which must tell all elements apart where the result is not to depend on `threads` (0: one per
/// core): pieces of about equal length, which are then merged in pairs.
template <class T>
void parallelSort(std::vector<T>& values, unsigned threads) {
  constexpr std::size_t kSmallestPiece = 1 << 15;
  const std::size_t most = std::bit_floor(std::size_t{threadCount(threads)});
  const std::size_t pieces = std::min(most, std::bit_floor(std::max<std::size_t>(1, values.size() / kSmallestPiece)));
  const auto border = [&](std::size_t piece) {
    return values.begin() + static_cast<std::ptrdiff_t>(values.size() * piece / pieces);
  };
  parallelParts(pieces, [&](std::size_t k) { std::sort(border(k), border(k + 1)); });
  for (std::size_t width = 1; width < pieces; width *= 2)
    parallelParts(pieces / (2 * width), [&](std::size_t k) {
      const std::size_t first = 2 * width * k;
      std::inplace_merge(border(first), border(first + width), border(first + 2 * width));
    });
}

}  // namespace palpate
