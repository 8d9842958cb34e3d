// A thinned copy of a cloud that answers, on the CPU and outside of the servo loop: what does the surface look like
// around here, and is there anything in the way?
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

/// A piece of surface, seen at one face.
struct LocalPlane {
  DVec3 position{0};  ///< weighted mean of the neighbours
  DVec3 normal{0};    ///< unit
  double reach = 0;   ///< distance of the farthest neighbour
};

/// Model units, relative to the cloud's origin, which may go once this is made.
class ThinnedCloud {
 public:
  /// Takes one point out of every run of equally many, so that at most `most` remain, and each place once. Throws Error
  /// for a cloud without points or normals.
  ThinnedCloud(const PointCloud& cloud, std::size_t most);

  std::size_t size() const { return positions_.size(); }
  DVec3 position(std::size_t i) const { return DVec3(positions_[i]); }
  DVec3 normal(std::size_t i) const { return DVec3(normals_[i]); }

  std::vector<NearPoint> nearest(const DVec3& p, std::size_t count) const;
  double distanceTo(const DVec3& p) const { return nearest(p, 1).front().distance; }

  /// The plane through the neighbours of `p` that face the same way as `facing`; none when there is no such neighbour.
  std::optional<LocalPlane> planeNear(const DVec3& p, const DVec3& facing) const;

  /// Whether a cone that opens from `p` along the unit vector `along` is empty between `from` and `to`. At a distance s
  /// it is `slope` s wide, and never wider than `widest`; model units.
  bool isFree(const DVec3& p, const DVec3& along, double from, double to, double slope, double widest) const;

 private:
  struct Surfels {
    std::vector<Vec3> positions, normals;
  };
  static Surfels surfelsOf(const PointCloud& cloud, std::size_t most);
  explicit ThinnedCloud(Surfels surfels);

  std::vector<Vec3> positions_;
  std::vector<Vec3> normals_;
  PointTree tree_;  // looks at positions_
};

}  // namespace palpate
