#include "engine/core/point_set.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <span>

namespace palpate::point_set_test {

namespace {

constexpr std::uint64_t kPoints = 5 * PointSet::kPage + 100;

std::vector<bool> bitsOf(const PointSet& set) {
  std::vector<bool> bits(kPoints);
  std::uint64_t last = 0;
  set.forEach([&](std::uint64_t point) {
    CHECK((last == 0 || point > last));
    bits.at(last = point) = true;
  });
  return bits;
}

}  // namespace

TEST_CASE("a point set holds what was set, in whole, empty and mixed pages, through flips and as words") {
  std::mt19937 random(3);
  PointSet set;
  std::vector<bool> expected(kPoints);
  for (int step = 0; step < 300; ++step) {
    const std::uint64_t a = random() % kPoints, b = random() % kPoints;
    const std::uint64_t page = a / PointSet::kPage * PointSet::kPage;
    PointSet change;
    switch (random() % 4) {
      case 0:
        change = PointSet::range(std::min(a, b), std::max(a, b));
        break;
      case 1:
        change = PointSet::range(page, std::min(page + PointSet::kPage, kPoints));
        break;
      case 2:
        change = set;  // leaves nothing
        break;
      default:
        for (int i = 0; i < 50; ++i) change.set(random() % kPoints, random() % 3 != 0);
    }
    const std::vector<bool> flipped = bitsOf(change);
    for (std::uint64_t i = 0; i < kPoints; ++i) expected[i] = expected[i] != flipped[i];
    const PointSet before = set;
    set.flip(change);
    const std::vector<bool> bits = bitsOf(set);
    REQUIRE(bits == expected);
    CHECK(set.count() == static_cast<std::uint64_t>(std::ranges::count(bits, true)));
    CHECK(set.empty() == (set.count() == 0));
    CHECK(set.test(a) == expected[a]);
    CHECK((set.end() == 0 || (set.test(set.end() - 1) && set.count() > 0)));
    const std::vector<std::uint64_t> words = set.words();
    std::span<const std::uint64_t> rest = words;
    PointSet read = change;
    CHECK(read.read(rest));
    CHECK(rest.empty());
    CHECK(read == set);
    rest = std::span(words).first(words.size() - 1);
    CHECK_FALSE(read.read(rest));
    PointSet undone = set;
    undone.flip(change);
    REQUIRE(undone == before);
    PointSet both = before, without = before;
    both.add(change);
    without.remove(change);
    const std::vector<bool> had = bitsOf(before), all = bitsOf(both), left = bitsOf(without);
    for (std::uint64_t i = 0; i < kPoints; ++i) {
      REQUIRE(all[i] == (had[i] || flipped[i]));
      REQUIRE(left[i] == (had[i] && !flipped[i]));
    }
  }
}

TEST_CASE("words of pages that are not in order, or too large, are refused, and equal sets are read as equal") {
  constexpr std::uint64_t kAll = ~std::uint64_t{0};
  const auto isRead = [](std::vector<std::uint64_t> words, PointSet& set) {
    std::span<const std::uint64_t> rest = words;
    return set.read(rest);
  };
  PointSet set;
  CHECK(isRead({2, 3, 1, kAll, 4, 1, kAll}, set));
  CHECK(set == PointSet::range(3 * PointSet::kPage, 5 * PointSet::kPage));
  CHECK_FALSE(isRead({2, 4, 1, kAll, 3, 1, kAll}, set));
  CHECK_FALSE(isRead({2, 4, 1, kAll, 4, 1, kAll}, set));
  CHECK_FALSE(isRead({1, 4, 2, kAll, kAll}, set));
  CHECK_FALSE(isRead({1, kAll / PointSet::kPage, 1, kAll}, set));  // the number after its last point does not exist
  CHECK(isRead({1, kAll / PointSet::kPage - 1, 1, kAll}, set));
  CHECK(set.end() == kAll / PointSet::kPage * PointSet::kPage);
  std::vector<std::uint64_t> whole{1, 7, 64};
  whole.resize(3 + 64, kAll);
  CHECK(isRead(whole, set));
  CHECK(set == PointSet::range(7 * PointSet::kPage, 8 * PointSet::kPage));
  std::ranges::fill(std::span(whole).subspan(3), 0);
  CHECK(isRead(whole, set));
  CHECK(set.empty());
}

TEST_CASE("a page with all of its points, however they were set, takes no more than a word") {
  const PointSet all = PointSet::range(0, 3 * PointSet::kPage);
  PointSet one;
  for (std::uint64_t point = 3 * PointSet::kPage; point-- > 0;) one.set(point);
  CHECK(one == all);
  CHECK(one.bytes() < 3 * 200);
  one.set(5000, false);
  CHECK(one.count() == 3 * PointSet::kPage - 1);
  CHECK(one.bytes() > PointSet::kPage / 8);
  one.set(5000);
  CHECK(one == all);
  one.flip(all);
  CHECK(one.bytes() == 0);
  CHECK(one == PointSet());
}

}  // namespace palpate::point_set_test
