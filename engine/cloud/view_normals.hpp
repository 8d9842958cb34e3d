// Normals of points that cameras saw.
#pragma once

#include <cstddef>
#include <span>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// What is known of a point besides its place.
struct PointSight {
  DVec3 towardsViews{0};  ///< sum of the unit directions to the places that it was seen from; zero: nobody saw it
  double weight = 1;      ///< how much it counts, positive: the inverse of the variance of its place, in any unit

  /// The point stands at `place`, and was seen from `eye`.
  void addView(const DVec3& place, const DVec3& eye);
};

/// Gives each point the normal of the plane that its nearest `neighbours` points fit best, each counting by its weight
/// and the less the farther it is (Hoppe, DeRose, Duchamp, McDonald and Stuetzle 1992, section 3.2, with weights), on
/// the side from which it was seen; where it was seen edge on, or by nobody, on the side from which its neighbours
/// were. Points that lie in no plane face their views. Always unit length. One sight for each point. The result does
/// not depend on `threads` (0: one per core).
void normalsFromViews(PointCloud& cloud, std::span<const PointSight> sights, unsigned neighbours = 16,
                      unsigned threads = 0);

/// Turns the normals of a cloud round that face away from the views of their points; how many those were. What nobody
/// saw stays. One sight for each point.
std::size_t faceViews(PointCloud& cloud, std::span<const PointSight> sights);

}  // namespace palpate
