#include "engine/select/point_bits.hpp"

#include <algorithm>

#include "engine/core/check.hpp"

namespace palpate {

PointBits::PointBits(const PointSet& set, std::size_t points) : PointBits(points) {
  set.forWords([&](std::uint64_t k, std::uint64_t word) {
    if (k < words_.size()) words_[k] = word;
  });
  if (points % kBits != 0) words_.back() &= (std::uint64_t{1} << points % kBits) - 1;
}

std::size_t PointBits::count() const {
  std::size_t count = 0;
  for (const std::uint64_t word : words_) count += static_cast<std::size_t>(std::popcount(word));
  return count;
}

// In the layout of PointSet::words(): point by point takes a hundred times as long.
PointSet PointBits::set() const {
  constexpr std::size_t kPage = PointSet::kPage / kBits;
  std::vector<std::uint64_t> all{0};
  for (std::size_t k = 0; k < words_.size(); k += kPage) {
    const auto page = std::span(words_).subspan(k, std::min(kPage, words_.size() - k));
    if (std::ranges::all_of(page, [](std::uint64_t word) { return word == 0; })) continue;
    ++all[0];
    all.insert(all.end(), {k / kPage, kPage});
    all.insert(all.end(), page.begin(), page.end());
    all.resize(all.size() + kPage - page.size());
  }
  PointSet set;
  std::span<const std::uint64_t> words = all;
  PALPATE_CHECK(set.read(words));
  return set;
}

PointBits& PointBits::operator&=(const PointBits& other) {
  PALPATE_CHECK(points_ == other.points_);
  for (std::size_t k = 0; k < words_.size(); ++k) words_[k] &= other.words_[k];
  return *this;
}

PointBits& PointBits::operator|=(const PointBits& other) {
  PALPATE_CHECK(points_ == other.points_);
  for (std::size_t k = 0; k < words_.size(); ++k) words_[k] |= other.words_[k];
  return *this;
}

PointBits& PointBits::operator-=(const PointBits& other) {
  PALPATE_CHECK(points_ == other.points_);
  for (std::size_t k = 0; k < words_.size(); ++k) words_[k] &= ~other.words_[k];
  return *this;
}

PointBits shownPoints(std::span<const PointState> points, const PointSet& hidden, unsigned threads) {
  return PointBits::where(points.size(), threads, [&](std::size_t i) { return !points[i].gone; }) -
         PointBits(hidden, points.size());
}

}  // namespace palpate
