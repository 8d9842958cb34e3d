#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/parallel.hpp"
#include "engine/core/point_set.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

/// A set of the points of a cloud as one bit for each, by number: many threads make it, and it is tested in constant
/// time. PointSet keeps it.
class PointBits {
 public:
  PointBits() = default;
  /// None of them.
  explicit PointBits(std::size_t points) : points_(points), words_((points + kBits - 1) / kBits) {}
  /// Points of `set` with larger numbers are left out.
  PointBits(const PointSet& set, std::size_t points);
  /// Those with holds(number), which is called from many threads.
  template <class Holds>
  static PointBits where(std::size_t points, unsigned threads, Holds&& holds) {
    PointBits bits(points);
    parallelFor(bits.words_.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        for (std::size_t i = k * kBits; i < std::min(points, (k + 1) * kBits); ++i)
          bits.words_[k] |= std::uint64_t{holds(i)} << i % kBits;
    });
    return bits;
  }

  std::size_t size() const { return points_; }
  bool test(std::size_t point) const { return (words_[point / kBits] >> point % kBits & 1) != 0; }
  void set(std::size_t point) { words_[point / kBits] |= std::uint64_t{1} << point % kBits; }
  /// Each of the points from `begin` on, which is a multiple of 64, is in the set if its truth is 1, not 0. Other
  /// threads may do so with other words.
  void put(std::size_t begin, std::span<const std::uint8_t> truths) {
    for (std::size_t i = 0; i < truths.size(); ++i) {
      std::uint64_t& word = words_[(begin + i) / kBits];
      if (i % kBits == 0) word = 0;
      word |= std::uint64_t{truths[i]} << i % kBits;
    }
  }
  /// From many threads. Returns whether it was not in the set.
  bool add(std::size_t point) {
    const std::uint64_t bit = std::uint64_t{1} << point % kBits;
    return (std::atomic_ref(words_[point / kBits]).fetch_or(bit, std::memory_order_relaxed) & bit) == 0;
  }
  std::size_t count() const;
  PointSet set() const;

  // With sets of as many points.
  PointBits& operator&=(const PointBits& other);
  PointBits& operator|=(const PointBits& other);
  PointBits& operator-=(const PointBits& other);
  friend PointBits operator&(PointBits a, const PointBits& b) { return a &= b; }
  friend PointBits operator|(PointBits a, const PointBits& b) { return a |= b; }
  friend PointBits operator-(PointBits a, const PointBits& b) { return a -= b; }
  bool operator==(const PointBits&) const = default;

 private:
  static constexpr std::size_t kBits = 64;

  std::size_t points_ = 0;
  std::vector<std::uint64_t> words_;
};

/// The points that exist and are not in `hidden`. `points`: by number.
PointBits shownPoints(std::span<const PointState> points, const PointSet& hidden, unsigned threads = 0);

}  // namespace palpate
