// Normals of points that cameras saw.
#pragma once

#include <cstddef>
#include <span>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Information on a point besides its position.
struct PointSight {
  DVec3 towardsViews{0};  ///< sum of the unit directions to the viewpoints; zero: no view
  double weight = 1;      ///< positive: the inverse of the variance of its position, in any unit

  /// Adds a view of the point at `place` from `eye`.
  void addView(const DVec3& place, const DVec3& eye);
};

/// Gives each point the normal of the least-squares plane of its nearest `neighbours` points, weighted by their weights
/// and by proximity (Hoppe, DeRose, Duchamp, McDonald and Stuetzle 1992, section 3.2, with weights), on the side from
/// which it was seen; if it was seen edge on, or has no view, on the side from which its neighbours were seen. Points
/// that do not span a plane face their views. Always unit length. One sight for each point. The result does not depend
/// on `threads` (0: one per core).
void normalsFromViews(PointCloud& cloud, std::span<const PointSight> sights, unsigned neighbours = 16,
                      unsigned threads = 0);

/// Flips the normals of a cloud that face away from the views of their points; returns their number. Points without
/// views keep theirs. One sight for each point.
std::size_t faceViews(PointCloud& cloud, std::span<const PointSight> sights);

}  // namespace palpate
