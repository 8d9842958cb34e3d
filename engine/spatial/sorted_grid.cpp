#include "engine/spatial/sorted_grid.hpp"

namespace palpate {

SortedGrid::SortedGrid(const HashGrid& grid, unsigned threads)
    : grid_(grid), team_(threads), sort_(grid.bucketMask + 1) {}

void SortedGrid::build(std::span<const Vec3> positions, std::span<const std::uint8_t> there) {
  PALPATE_CHECK(there.empty() || there.size() == positions.size());
  positions_ = positions;
  there_ = there;
  const auto bucketAt = [grid = grid_, positions, there](std::size_t i) {
    return there.empty() || there[i] ? bucketOf(grid, cellOf(grid, positions[i])) : kNoBucket;
  };
  sort_.sort(positions.size(), team_, bucketAt, [positions](std::size_t i, Placed& placed) {
    placed.position = positions[i];
    placed.number = static_cast<std::uint32_t>(i);
  });
}

void SortedGrid::move(std::span<const PointMove> moves) {
  if (!moves.empty()) build(positions_, there_);
}

void SortedGrid::near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const {
  forEachNear(center, radius, [&](const Placed& point) { found.push_back(point.number); });
}

}  // namespace palpate
