// Positions grouped by the cells around them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/spatial/gathered_points.hpp"

namespace palpate {

/// Groups positions whose balls touch the same cells, so that their neighbours are gathered once (GatheredPoints).
/// Keeps its memory between uses.
class CellGroups {
 public:
  struct Group {
    GatheredPoints::Balls balls;         ///< of the members
    std::uint32_t first = 0, count = 0;  ///< in members()
  };

  /// Groups the indices below `count`: ball(i) gives the position and the radius of each.
  template <class Ball>
  void assign(const HashGrid& grid, std::size_t count, Ball&& ball);
  std::span<const Group> groups() const { return groups_; }
  /// The indices of a group, ascending.
  std::span<const std::uint32_t> members(const Group& group) const {
    return {members_.data() + group.first, group.count};
  }

 private:
  void begin(std::size_t count);
  void put(std::uint32_t index, const DVec3& place, double radius, const CellBox& box);
  void end();

  std::vector<Group> groups_;
  std::vector<std::uint32_t> groupOf_;  // by index
  std::vector<std::uint32_t> members_;
  std::vector<std::uint32_t> table_;  // by hash of a box: number of its group, or kNone
};

template <class Ball>
void CellGroups::assign(const HashGrid& grid, std::size_t count, Ball&& ball) {
  begin(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [place, radius] = ball(i);
    put(static_cast<std::uint32_t>(i), place, radius, cellsAround(grid, place, radius));
  }
  end();
}

}  // namespace palpate
