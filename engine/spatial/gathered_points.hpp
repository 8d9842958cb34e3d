// The points around a group of positions, gathered once for all of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/spatial/sorted_grid.hpp"

namespace palpate {

/// Points near a position, in the order in which SortedGrid::forEachNear() visits them. Keeps its memory between uses.
/// Used by one thread.
class NearPoints {
 public:
  NearPoints() = default;
  /// All of these, by index.
  explicit NearPoints(std::span<const DVec3> offsets);

  std::size_t size() const { return count_; }
  /// In the gathered points.
  std::span<const std::uint32_t> indices() const { return {index_.data(), count_}; }
  /// Coordinates of the offsets from the position, model units.
  const double* x() const { return x_.data(); }
  const double* y() const { return y_.data(); }
  const double* z() const { return z_.data(); }
  /// The indices of the closest, as the search says.
  std::span<const std::uint32_t> closest() const { return {closest_.data(), closestCount_}; }
  /// Leaves out all but the first ones.
  void truncate(std::size_t most) { count_ = std::min(count_, most); }

 private:
  friend class GatheredPoints;
  void makeRoom(std::size_t count);

  std::size_t count_ = 0, closestCount_ = 0;
  std::vector<std::uint32_t> index_, closest_;
  std::vector<double> x_, y_, z_;
  std::vector<double> squared_;  // distances, of the points that were searched
};

/// The neighbours of positions whose balls touch the same cells: one pass over these cells, then a pass over
/// consecutive memory for each position. Keeps its memory between gathers. After gather() it may be searched by many
/// threads.
class GatheredPoints {
 public:
  /// Positions, and the radius of the balls about them.
  struct Balls {
    DVec3 low, high;  ///< bounds of the positions, relative to the cloud's origin, model units
    double radius;    ///< model units
    CellBox box;      ///< cells of each of the balls: cellsAround()
  };
  /// Gathers the points around all of these balls. A box of more than SortedGrid::kFewCells cells requires a single
  /// position.
  void gather(const SortedGrid& grid, const Balls& balls);
  /// Numbers of the gathered points.
  std::span<const std::uint32_t> numbers() const { return {numbers_.data(), count_}; }
  DVec3 position(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }

  /// The points nearer than `radius` to a position, which is one of those gathered for; those nearer than
  /// `closest`, which is not more, are the closest.
  void near(const DVec3& place, double radius, NearPoints& near, double closest = 0) const;
  /// The same among points with these indices, but for the one with the number `without`.
  void near(const DVec3& place, double radius, std::span<const std::uint32_t> among, std::uint32_t without,
            NearPoints& near) const;

 private:
  void makeRoom(std::size_t more);

  std::size_t count_ = 0;
  std::vector<float> x_, y_, z_;
  std::vector<std::uint32_t> numbers_;
};

}  // namespace palpate
