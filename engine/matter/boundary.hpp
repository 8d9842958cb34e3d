// Bodies of points that matter does not pass (Akinci et al. 2012): a ball that a hand holds; any cloud of points with
// volumes can be one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/matter/cell_grid.hpp"
#include "engine/matter/matter_scene.hpp"
#include "shaders/shared/matter_bodies.h"

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

/// A point of a body, near a place, and its number, for life.
struct BoundaryMeeting : shared::BodyMeeting {
  std::uint32_t number;
};

/// A body as matter meets it: rigid, its points in cells of their own, which never change.
class BoundaryBody {
 public:
  /// `support`: radius of the weights, m. `kept`: what is nearer to the middle is pushed out, m; 0: nothing is. Throws
  /// nothing; without points it is nowhere.
  BoundaryBody(std::span<const BoundaryPoint> points, float support, float kept);

  /// `grown_m`: so far from its middle the body is there.
  void moveTo(const BodyMotion& motion, double grown_m);
  /// How the velocity of what is within changes, so that it goes out, m/s.
  Vec3 pushedOut(const Vec3& place, float step_s) const {
    return shared::pushedOut<float>(pose_, place, kept_, push(), step_s);
  }
  /// So far it goes in a substep at the most, m.
  float push() const;
  float kept() const { return kept_; }
  const Vec3& place() const { return pose_.place; }  ///< of the middle, m
  std::uint32_t size() const { return static_cast<std::uint32_t>(points_.size()); }

  /// Calls meet(BoundaryMeeting) for each point within the support radius of `place`, always in the same order.
  template <class Meet>
  void forEachNear(const Vec3& place, Meet&& meet) const;

  /// Each point in the order of the cells: place in their box, volume.
  std::span<const Vec4> points() const { return points_; }
  const CellGrid& grid() const { return grid_; }
  const Vec3& middle() const { return middle_; }  ///< of the body in that box, m
  float extent() const { return extent_; }        ///< of the points from the middle, m

 private:
  float support_, kept_;
  float extent_ = 0;
  CellGrid grid_;
  std::vector<Vec4> points_;
  Vec3 middle_{0};
  shared::BodyPose pose_;
};

/// The ball of a scene's tool; without points where it has none.
BoundaryBody ballBody(const MatterScene& scene, const MatterPlan& plan);

template <class Meet>
void BoundaryBody::forEachNear(const Vec3& place, Meet&& meet) const {
  const Vec3 seen = inBody(pose_, place);
  const float far = extent_ + support_;
  if (!(glm::dot(seen, seen) < far * far)) return;
  const Vec3 here = seen + middle_;
  grid_.forEachRun(here, [&](std::uint32_t begin, std::uint32_t end, std::uint32_t) {
    for (std::uint32_t k = begin; k < end; ++k) {
      const Vec3 offset = here - Vec3(points_[k]);
      if (!(glm::dot(offset, offset) < support_ * support_)) continue;
      meet(BoundaryMeeting{shared::bodyMeeting(pose_, place, offset, support_, points_[k].w), k});
    }
  });
}

}  // namespace palpate
