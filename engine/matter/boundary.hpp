// Bodies of points that matter does not pass (Akinci et al. 2012): a ball that a hand holds; any cloud of points with
// volumes can be one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/matter/cell_grid.hpp"

namespace palpate {

/// A point of a boundary, which stands for some volume.
struct BoundaryPoint {
  Vec3 place{0};     ///< from the middle of the body, m
  float volume = 0;  ///< in cubes of the spacing
};

/// Points that fill a ball as deep as weights reach into it, layer by layer, as matter at rest would.
std::vector<BoundaryPoint> ballPoints(double radius_m, double spacing_m, double support_m);

/// Where a body is, and how it moves. m, m/s, rad/s.
struct BodyMotion {
  DVec3 place{0}, velocity{0}, spin{0};
  DQuat orientation{1, 0, 0, 0};
};

/// A point of a body, near a place.
struct BoundaryMeeting {
  Vec3 offset;           ///< from the point to the place, m
  float r;               ///< the length of that, in support radii
  float volume;          ///< BoundaryPoint::volume
  Vec3 velocity;         ///< of the point, m/s
  std::uint32_t number;  ///< of the point, for life
};

/// A body as matter meets it: rigid, its points in cells of their own, which never change.
class BoundaryBody {
 public:
  /// `support`: radius of the weights, m. Throws nothing; without points it is nowhere.
  BoundaryBody(std::span<const BoundaryPoint> points, float support);

  void moveTo(const BodyMotion& motion);
  const DVec3& place() const { return motion_.place; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(points_.size()); }

  /// Calls meet(BoundaryMeeting) for each point within the support radius of `place`, always in the same order.
  template <class Meet>
  void forEachNear(const Vec3& place, Meet&& meet) const;

 private:
  float support_;
  float extent_ = 0;  // of the points from the middle
  CellGrid cells_;
  std::vector<Vec4> points_;  // in the order of the cells: place in the box of the cells, volume
  Vec3 middle_{0};            // of the body in that box
  BodyMotion motion_;
  glm::mat3 toBody_{1}, toWorld_{1};
  Vec3 place_{0}, velocity_{0}, spin_{0};
};

template <class Meet>
void BoundaryBody::forEachNear(const Vec3& place, Meet&& meet) const {
  const Vec3 fromMiddle = place - place_;
  const float far = extent_ + support_;
  if (!(glm::dot(fromMiddle, fromMiddle) < far * far)) return;
  const Vec3 here = toBody_ * fromMiddle + middle_;
  cells_.forEachRun(here, [&](std::uint32_t begin, std::uint32_t end, std::uint32_t) {
    for (std::uint32_t k = begin; k < end; ++k) {
      const Vec3 offset = here - Vec3(points_[k]);
      const float distance2 = glm::dot(offset, offset);
      if (!(distance2 < support_ * support_)) continue;
      const Vec3 seen = toWorld_ * offset;
      meet(BoundaryMeeting{.offset = seen,
                           .r = std::sqrt(distance2) / support_,
                           .volume = points_[k].w,
                           .velocity = velocity_ + glm::cross(spin_, fromMiddle - seen),
                           .number = k});
    }
  });
}

}  // namespace palpate
