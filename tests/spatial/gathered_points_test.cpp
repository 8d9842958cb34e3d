// Neighbours gathered once for a group of positions, against a query for each of them.
#include "engine/spatial/gathered_points.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <random>

#include "engine/spatial/cell_groups.hpp"

namespace palpate::gathered_points_test {

namespace {

std::vector<Vec3> somewhere(std::size_t count, float height) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> share(-1, 1);
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < count; ++i)
    places.push_back(Vec3{10 * share(random), 10 * share(random), height * share(random)});
  return places;
}

struct Found {
  std::vector<std::uint32_t> numbers;
  std::vector<DVec3> offsets;
  bool operator==(const Found&) const = default;
};

Found oneByOne(const SortedGrid& grid, const DVec3& place, double radius) {
  Found found;
  grid.forEachNear(place, radius, [&](const SortedGrid::Placed& near) {
    found.numbers.push_back(near.number);
    found.offsets.push_back(DVec3(near.position) - place);
  });
  return found;
}

Found gathered(const GatheredPoints& points, const DVec3& place, double radius) {
  NearPoints near, again;
  points.near(place, radius, near, 0.5 * radius);
  points.near(place, radius, near.indices(), std::numeric_limits<std::uint32_t>::max(), again);
  CHECK(std::ranges::equal(near.indices(), again.indices()));
  points.near(place, 0.5 * radius, near.indices(), std::numeric_limits<std::uint32_t>::max(), again);
  CHECK(std::ranges::equal(near.closest(), again.indices()));
  Found found;
  for (std::size_t k = 0; k < near.size(); ++k) {
    found.numbers.push_back(points.numbers()[near.indices()[k]]);
    found.offsets.emplace_back(near.x()[k], near.y()[k], near.z()[k]);
  }
  return found;
}

}  // namespace

TEST_CASE("neighbours gathered for a group are those of each of its positions, in the same order") {
  const std::vector<Vec3> positions = somewhere(4000, 1);
  for (const double cell : {0.05, 0.3, 0.7, 5.0}) {  // from a box of too many cells to one of few
    CAPTURE(cell);
    SortedGrid grid(makeHashGrid(Vec3(-10), cell, positions.size()), 1);
    grid.build(positions);
    CellGroups groups;
    const auto radiusOf = [](std::size_t i) { return i % 3 == 0 ? 0.35 : 0.7; };
    groups.assign(grid.grid(), positions.size(),
                  [&](std::size_t i) { return std::pair(DVec3(positions[i]), radiusOf(i)); });
    std::vector<int> met(positions.size());
    std::size_t wrong = 0;
    GatheredPoints points;
    for (const CellGroups::Group& group : groups.groups()) {
      points.gather(grid, group.balls);
      for (const std::uint32_t i : groups.members(group)) {
        ++met[i];
        const DVec3 place(positions[i]);
        wrong += !(gathered(points, place, radiusOf(i)) == oneByOne(grid, place, radiusOf(i)));
      }
    }
    CHECK(wrong == 0);
    CHECK(std::ranges::count(met, 1) == static_cast<std::ptrdiff_t>(positions.size()));
    if (cell > 1) CHECK(groups.groups().size() < positions.size() / 4);
  }
}

}  // namespace palpate::gathered_points_test
