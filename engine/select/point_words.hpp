// Sets of points from a truth for each point, made by many threads.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "engine/core/check.hpp"
#include "engine/core/parallel.hpp"
#include "engine/core/point_set.hpp"

namespace palpate {

/// A bit for each point, in the layout that PointSet reads: pages of words, each behind its number and its length.
class PointWords {
 public:
  explicit PointWords(std::size_t points) : words_(1 + (points + PointSet::kPage - 1) / PointSet::kPage * kStride) {
    words_[0] = (words_.size() - 1) / kStride;
    for (std::size_t page = 0; page < words_[0]; ++page)
      words_[1 + page * kStride] = page, words_[2 + page * kStride] = kWords;
  }

  /// Sets the points from `begin`, a multiple of 64, on: each by whether it is 1 or 0. Other threads may set others, if
  /// these are in other words.
  void set(std::size_t begin, std::span<const std::uint8_t> truths) {
    for (std::size_t i = 0; i < truths.size(); i += 64) {
      std::uint64_t word = 0;
      const std::size_t count = std::min<std::size_t>(64, truths.size() - i);
      for (std::size_t k = 0; k < count; ++k) word |= std::uint64_t{truths[i + k]} << k;
      wordOf(begin + i) = word;
    }
  }
  PointSet points() const {
    PointSet set;
    std::span<const std::uint64_t> words(words_);
    PALPATE_CHECK(set.read(words));
    return set;
  }

 private:
  static constexpr std::size_t kWords = PointSet::kPage / 64, kStride = kWords + 2;
  std::uint64_t& wordOf(std::size_t point) {
    return words_[1 + point / PointSet::kPage * kStride + 2 + point % PointSet::kPage / 64];
  }
  std::vector<std::uint64_t> words_;
};

/// The points for which holds(i) is true; called from many threads.
template <class Holds>
PointSet pointsThat(std::size_t count, unsigned threads, Holds&& holds) {
  PointWords words(count);
  parallelBlocks(count, PointSet::kPage, threads, [&](std::size_t begin, std::size_t end) {
    std::array<std::uint8_t, PointSet::kPage> truths;
    for (std::size_t i = begin; i < end; ++i) truths[i - begin] = holds(i) ? 1 : 0;
    words.set(begin, {truths.data(), end - begin});
  });
  return words.points();
}

}  // namespace palpate
