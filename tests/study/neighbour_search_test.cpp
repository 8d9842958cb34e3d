// One test body for every search structure: it finds what brute force finds.
#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <random>

#include "engine/cloud/point_tree.hpp"
#include "engine/spatial/sorted_grid.hpp"
#include "engine/study/dynamic_tree.hpp"
#include "tests/random_positions.hpp"

namespace palpate::neighbour_search_test {

namespace {

using Numbers = std::vector<std::uint32_t>;

// Calls check(search) with each structure, empty.
void forEachStructure(const HashGrid& grid, auto&& check) {
  check(std::make_unique<MultimapHash>(grid));
  check(std::make_unique<SortedGrid>(grid, 1));
  check(std::make_unique<SortedGrid>(grid, 3));
  check(std::make_unique<PointTree>());
  check(std::make_unique<DynamicTree>());
}

Numbers bruteForce(std::span<const Vec3> positions, const DVec3& center, double radius) {
  Numbers found;
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    const DVec3 d = DVec3(positions[i]) - center;
    if (glm::dot(d, d) < radius * radius) found.push_back(i);
  }
  return found;
}

void checkFinds(const auto& search, std::span<const Vec3> positions, std::span<const DVec3> centers, double radius) {
  CAPTURE(search.name());
  std::size_t wrong = 0;
  for (const DVec3& center : centers) {
    Numbers found;
    search.near(center, radius, found);
    std::ranges::sort(found);
    wrong += found != bruteForce(positions, center, radius);
  }
  CHECK(wrong == 0);
}

// Positions on, beside and far from the points.
std::vector<DVec3> centersFor(std::span<const Vec3> positions, double radius) {
  std::vector<DVec3> centers{DVec3(0), DVec3(-1e7, 2e7, 3), DVec3(1e30)};
  for (const std::size_t i : {std::size_t{0}, positions.size() / 3, positions.size() / 2, positions.size() - 1}) {
    if (i >= positions.size()) continue;
    centers.emplace_back(positions[i]);
    centers.push_back(DVec3(positions[i]) + radius * DVec3(0.3, -0.6, 0.1));
  }
  return centers;
}

// Every structure over `positions` with cells of edge `cell`, at radii that span one cell and more.
void checkAll(const std::vector<Vec3>& positions, double cell) {
  CAPTURE(positions.size());
  for (const BucketKey key : {BucketKey::teschner, BucketKey::morton})
    forEachStructure(makeHashGrid(Vec3(-3), cell, positions.size(), key), [&](const auto& search) {
      search->build(positions);
      for (const double radius : {0.4 * cell, cell, 3 * cell})
        checkFinds(*search, positions, centersFor(positions, radius), radius);
    });
}

}  // namespace

TEST_CASE("neighbour search finds what brute force finds, at counts around block sizes") {
  for (const std::size_t count : {0, 1, 2, 255, 256, 257, 65'537}) checkAll(randomPositions(count, Vec3(0), 50), 4);
}

TEST_CASE("neighbour search finds coincident, collinear and lattice points") {
  checkAll(std::vector<Vec3>(5000, Vec3(3, -4, 5)), 1);
  std::vector<Vec3> line, lattice;
  for (int i = 0; i < 3000; ++i) line.emplace_back(0.01f * static_cast<float>(i) - 7, 2, 2);
  for (int i = 0; i < 4096; ++i) lattice.emplace_back(i % 16, i / 16 % 16, i / 256);
  checkAll(line, 0.1);
  checkAll(lattice, 1);
  auto doubled = randomPositions(2000, Vec3(0), 5);
  doubled.insert(doubled.end(), doubled.begin(), doubled.end());
  checkAll(doubled, 0.5);
}

TEST_CASE("neighbour search finds points at far coordinates, where single precision is coarser than a cell") {
  checkAll(randomPositions(3000, Vec3(-40, -40, -40), 10), 0.7);
  checkAll(randomPositions(3000, Vec3(-1e6f, 2e6f, -3e6f), 5), 1);
  checkAll(randomPositions(3000, Vec3(1e6f), 2), 0.05);
}

TEST_CASE("neighbour search finds all points despite a far outlier") {
  auto positions = randomPositions(20'000, Vec3(0), 1);
  positions.emplace_back(1e6f, -1e6f, 1e6f);
  checkAll(positions, 0.1);
}

TEST_CASE("neighbour search works if far more cells than points, or all points, are in reach") {
  const auto positions = randomPositions(2000, Vec3(0), 1);
  forEachStructure(makeHashGrid(Vec3(0), 1e-4, positions.size()), [&](const auto& search) {
    search->build(positions);
    checkFinds(*search, positions, centersFor(positions, 0.5), 0.5);
    checkFinds(*search, positions, centersFor(positions, 1e9), 1e9);
  });
}

TEST_CASE("neighbour search finds points after repeated moves and after a rebuild with another cloud") {
  auto positions = randomPositions(10'007, Vec3(0), 10);
  const auto others = randomPositions(301, Vec3(5), 10);
  forEachStructure(makeHashGrid(Vec3(0), 0.8, positions.size()), [&](const auto& search) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> step(-3, 3);
    search->build(positions);
    for (int turn = 0; turn < 3; ++turn) {
      std::vector<PointMove> moves;
      for (std::uint32_t i = turn; i < positions.size(); i += 7) {
        moves.push_back({i, positions[i]});
        positions[i] += Vec3{step(random), step(random), step(random)};
      }
      search->move(moves);
      checkFinds(*search, positions, centersFor(positions, 1.3), 1.3);
    }
    search->move({});
    checkFinds(*search, positions, centersFor(positions, 1.3), 1.3);
    search->build(others);
    checkFinds(*search, others, centersFor(others, 1.3), 1.3);
  });
}

TEST_CASE("the sorted grid has the points of each bucket in their order, with any number of threads") {
  for (const std::size_t count : {0, 1, 255, 257, 8192, 65'537, 300'007}) {
    const auto positions = randomPositions(count, Vec3(0), 50);
    for (const BucketKey key : {BucketKey::teschner, BucketKey::morton}) {
      const HashGrid grid = makeHashGrid(Vec3(-50), 1.5, count, key);
      const auto bucketAt = [&](std::uint32_t i) { return bucketOf(grid, cellOf(grid, positions[i])); };
      Numbers order(count);
      std::iota(order.begin(), order.end(), 0u);
      std::ranges::stable_sort(order, {}, bucketAt);
      for (const unsigned threads : {1u, 2u, 3u}) {
        SortedGrid sorted(grid, threads);
        sorted.build(positions);
        std::size_t wrong = sorted.placed().size() != count;
        for (std::size_t i = 0; i < count; ++i) {
          const auto& placed = sorted.placed()[i];
          wrong += placed.number != order[i] || placed.position != positions[placed.number];
        }
        for (std::uint32_t bucket = 0, first = 0; bucket <= grid.bucketMask; ++bucket) {
          const UVec2 range = sorted.range(bucket);
          wrong += range.x != first;
          while (first < count && bucketAt(order[first]) == bucket) ++first;
          wrong += range.y != first;
        }
        CHECK(wrong == 0);
      }
    }
  }
}

TEST_CASE("a rebuild of the sorted grid with at most the same size allocates no memory") {
  const auto positions = randomPositions(50'000, Vec3(0), 50), others = randomPositions(49'999, Vec3(9), 50);
  SortedGrid grid(makeHashGrid(Vec3(0), 1.5, positions.size()), 2);
  grid.build(positions);
  const auto* first = grid.placed().data();
  const std::size_t bytes = grid.bytes();
  CHECK(bytes < 60 * positions.size());
  grid.build(positions);
  CHECK(grid.bytes() == bytes);
  CHECK(grid.placed().data() == first);
  grid.build(others);
  CHECK(grid.placed().data() == first);
}

}  // namespace palpate::neighbour_search_test
