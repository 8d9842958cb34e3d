// Neighbourhood search on the CPU, behind one interface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// A point that has moved: its number, and its previous position.
struct PointMove {
  std::uint32_t point;
  Vec3 from;
};

/// Finds the points near a position. A point's number is its index in the positions.
class NeighbourSearch {
 public:
  virtual ~NeighbourSearch() = default;

  /// Sets the points. Keeps a view of `positions`, which must outlive its use here.
  virtual void build(std::span<const Vec3> positions) = 0;
  /// Updates the structure for points that have moved in the positions; each at most once.
  virtual void move(std::span<const PointMove> moves) = 0;
  /// Appends every point strictly nearer than `radius` to `center`, once, in any order. Distances in double precision.
  virtual void near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const = 0;

  virtual std::string_view name() const = 0;
  /// Memory in addition to the positions.
  virtual std::size_t bytes() const = 0;
};

}  // namespace palpate
