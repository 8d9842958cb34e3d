// A subsampled copy of a cloud for queries on the CPU, outside of the servo loop: the local shape of the surface, and
// whether there is free space above it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/point_tree.hpp"

namespace palpate {

/// A point of the thinned cloud near a position.
struct NearPoint {
  std::uint32_t index = 0;
  double distance = 0;  ///< model units
};

/// A piece of one face of a surface.
struct LocalPlane {
  DVec3 position{0};  ///< weighted mean of the neighbours
  DVec3 normal{0};    ///< unit
  double reach = 0;   ///< distance of the farthest neighbour
};

/// Model units, relative to the cloud's origin. The cloud need not outlive it.
class ThinnedCloud {
 public:
  /// Takes one point of each run of equal length, so that at most `most` remain, and each position once. Throws Error
  /// for a cloud without points or normals.
  ThinnedCloud(const PointCloud& cloud, std::size_t most);

  std::size_t size() const { return positions_.size(); }
  DVec3 position(std::size_t i) const { return DVec3(positions_[i]); }
  DVec3 normal(std::size_t i) const { return DVec3(normals_[i]); }

  std::vector<NearPoint> nearest(const DVec3& p, std::size_t count) const;
  double distanceTo(const DVec3& p) const { return nearest(p, 1).front().distance; }

  /// Plane through the neighbours of `p` that face the same way as `facing`; nothing if there is no such neighbour.
  std::optional<LocalPlane> planeNear(const DVec3& p, const DVec3& facing) const;

  /// Whether a cone that opens from `p` along the unit vector `along` is empty between `from` and `to`. At a distance s
  /// its width is `slope` s, at most `widest`; model units.
  bool isFree(const DVec3& p, const DVec3& along, double from, double to, double slope, double widest) const;

 private:
  struct Surfels {
    std::vector<Vec3> positions, normals;
  };
  static Surfels surfelsOf(const PointCloud& cloud, std::size_t most);
  explicit ThinnedCloud(Surfels surfels);

  std::vector<Vec3> positions_;
  std::vector<Vec3> normals_;
  PointTree tree_;  // refers to positions_
};

}  // namespace palpate
