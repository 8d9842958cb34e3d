// The points of a cloud while it is sculpted on the CPU: they come and go, each keeps its id.
#pragma once

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// One entry per point in every array that is not empty, ascending by id. A point's number is its place in them.
struct SculptedPoints {
  std::vector<Vec3> positions;         ///< model units, relative to the cloud's origin
  std::vector<Vec3> normals;           ///< unit
  std::vector<std::uint32_t> colors;   ///< RGBA8; empty where the cloud has none
  std::vector<std::uint32_t> ids;      ///< number in the file; points that came later have the numbers behind those
  std::vector<std::uint32_t> parents;  ///< id of the point of the file that the other properties come from
  std::vector<float> spacings;         ///< target: the local spacing of the cloud as loaded, model units
  /// Points that have moved, are new, or have not got what they wished for: the next tick looks at them.
  std::vector<std::uint8_t> unsettled;

  /// `cloud` must have normals. Spacings are left empty.
  explicit SculptedPoints(const PointCloud& cloud);
  std::size_t size() const { return positions.size(); }

  /// Adds a point at `position` with an id beyond all others. Its normal, colour and target are the middle of those of
  /// two points, its parent is that of the first.
  void insertBetween(std::uint32_t number, std::uint32_t other, const Vec3& position, std::uint32_t id);
  /// Takes away all points whose flag is not 0; there is one for each of the first points.
  void erase(const std::vector<std::uint8_t>& gone);

  /// Writes the points into `cloud`, which must be the one they were made from; says how many points have moved, come
  /// or gone.
  std::size_t readBack(PointCloud& cloud) const;
};

}  // namespace palpate
