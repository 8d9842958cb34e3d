// Cells by Morton codes: sort order, lookup, and neighbourhood.

#include <doctest/doctest.h>

#include <algorithm>
#include <glm/vector_relational.hpp>
#include <set>
#include <vector>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/morton.hpp"

namespace palpate::morton_cells_test {
namespace {

/// Cells within `reach` of the centre, on both sides of it.
BareVector<std::uint64_t> someCodes(std::size_t count, std::int32_t reach) {
  BareVector<std::uint64_t> codes(count);
  for (std::size_t i = 0; i < count; ++i) {
    IVec3 cell;
    for (int k = 0; k < 3; ++k)
      cell[k] =
          kMortonReach - reach + static_cast<std::int32_t>(2 * reach * randomUnit(static_cast<std::uint64_t>(k), i));
    codes[i] = mortonCode(cell);
  }
  return codes;
}

constexpr std::int32_t kReaches[] = {1, 2, 3, 500, 100'000, kMortonReach};

}  // namespace

TEST_CASE("a Morton code is decoded to its cell") {
  for (const IVec3 cell : {IVec3(0), IVec3(1, 2, 3), IVec3(2 * kMortonReach - 1, 0, 77), IVec3(2 * kMortonReach - 1)})
    CHECK(mortonCellOf(mortonCode(cell)) == cell);
}

TEST_CASE("sorting by the distinguishing bits equals sorting by all, however far cells are from the middle") {
  struct Entry {
    std::uint64_t code;
    std::size_t number;
  };
  for (const std::int32_t reach : kReaches)
    for (const std::size_t count : {0u, 1u, 2u, 1025u, 20'000u}) {
      CAPTURE(reach);
      CAPTURE(count);
      BareVector<Entry> entries;
      for (const std::uint64_t code : someCodes(count, reach)) entries.push_back({code, entries.size()});
      BareVector<Entry> expected = entries;
      std::ranges::stable_sort(expected, {}, &Entry::code);
      for (const unsigned threads : {1u, 3u}) {
        BareVector<Entry> sorted = entries;
        sortByMorton(sorted, threads, [](const Entry& entry) { return entry.code; });
        CHECK(std::ranges::equal(sorted, expected, {}, &Entry::number, &Entry::number));
      }
    }
}

TEST_CASE("each cell has its values, and all occupied cells around a cell are found once, with any number of threads") {
  for (const std::int32_t reach : kReaches)
    for (const std::size_t count : {0u, 1u, 2u, 1023u, 1025u, 20'000u}) {
      CAPTURE(reach);
      CAPTURE(count);
      BareVector<std::uint64_t> some = someCodes(count, reach);
      std::ranges::sort(some);
      const std::set<std::uint64_t> each(some.begin(), some.end());
      for (const unsigned threads : {1u, 4u}) {
        const MortonCells cells(some.size(), threads, [&](std::size_t k) { return some[k]; });
        REQUIRE(cells.count() == each.size());
        bool same = true;
        for (std::size_t cell = 0, k = 0; cell < cells.count(); ++cell) {
          same = same && cells.begin(cell) == k;
          while (k < some.size() && some[k] == cells.code(cell)) ++k;
          same = same && cells.end(cell) == k;
        }
        // Around occupied cells, and next to them.
        for (std::uint64_t cell = 0; cell < std::min<std::size_t>(cells.count(), 3000); ++cell)
          for (const std::int32_t aside : {0, 1}) {
            const IVec3 at = mortonCellOf(cells.code(cell)) + IVec3(aside, 0, aside);
            std::vector<std::uint64_t> found, expected;
            cells.forEachAround(at, [&](std::uint32_t near) { found.push_back(cells.code(near)); });
            for (int k = 0; k < 27; ++k) {
              const IVec3 near = at + IVec3(k % 3, k / 3 % 3, k / 9) - 1;
              const bool inside = glm::all(glm::greaterThanEqual(near, IVec3(0))) &&
                                  glm::all(glm::lessThan(near, IVec3(2 * kMortonReach)));
              if (inside && each.contains(mortonCode(near))) expected.push_back(mortonCode(near));
            }
            std::ranges::sort(found), std::ranges::sort(expected);
            same = same && found == expected;
          }
        CHECK(same);
      }
    }
  MortonCells().forEachAround(IVec3(kMortonReach), [](std::uint32_t) { FAIL("of no cells one was found"); });
}

}  // namespace palpate::morton_cells_test
