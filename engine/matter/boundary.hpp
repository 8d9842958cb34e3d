// Bodies of boundary points that matter does not pass (Akinci et al. 2012): the ball held by a hand; any cloud of
// points with volumes can be one.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/matter/cell_grid.hpp"
#include "engine/matter/matter_scene.hpp"
#include "shaders/shared/matter_bodies.h"

namespace palpate {

/// A point of a boundary, which represents a volume.
struct BoundaryPoint {
  Vec3 place{0};     ///< relative to the centre of the body, m
  float volume = 0;  ///< in units of the cubed spacing
};

/// Points that fill a ball to the depth that weights reach, layer by layer, like matter at rest.
std::vector<BoundaryPoint> ballPoints(double radius_m, double spacing_m, double support_m);

/// Pose and velocities of a body. m, m/s, rad/s.
struct BodyMotion {
  DVec3 place{0}, velocity{0}, spin{0};
  DQuat orientation{1, 0, 0, 0};
};

/// A point of a body near a position, with its permanent number.
struct BoundaryMeeting : shared::BodyMeeting {
  std::uint32_t number;
};

/// A rigid body in contact with matter; its points are in cells of their own, which never change.
class BoundaryBody {
 public:
  /// `support`: radius of the weights, m. `kept`: matter nearer to the centre is pushed out, m; 0: disabled. Throws
  /// nothing; without points it has no effect.
  BoundaryBody(std::span<const BoundaryPoint> points, float support, float kept);

  /// `grown_m`: radius up to which the body is present.
  void moveTo(const BodyMotion& motion, double grown_m);
  /// Change of the velocity of matter inside that pushes it out, m/s.
  Vec3 pushedOut(const Vec3& place, float step_s) const {
    const Vec3 away = place - pose_.place;
    if (glm::dot(away, away) >= kept_ * kept_) return Vec3(0);
    return shared::pushedOut<float>(pose_, place, kept_, push(), step_s);
  }
  /// Maximum displacement of that push in a substep, m.
  float push() const;
  float kept() const { return kept_; }
  const Vec3& place() const { return pose_.place; }  ///< of the centre, m
  std::uint32_t size() const { return static_cast<std::uint32_t>(points_.size()); }

  /// Whether a position may be within the support radius of a point.
  bool isNear(const Vec3& place) const {
    constexpr float kFarther = 1.001f;  // a rotation rounds
    const Vec3 away = place - pose_.place;
    const float far = kFarther * (extent_ + support_);
    return glm::dot(away, away) < far * far;
  }
  /// Calls meet(BoundaryMeeting) for each point within the support radius of `place`, always in the same order.
  template <class Meet>
  void forEachNear(const Vec3& place, Meet&& meet) const;

  /// All points in the order of the cells: position in their box, volume.
  std::span<const Vec4> points() const { return points_; }
  const CellGrid& grid() const { return grid_; }
  const Vec3& middle() const { return middle_; }  ///< centre of the body in that box, m
  float extent() const { return extent_; }        ///< maximum distance of the points from the centre, m

 private:
  float support_, kept_;
  float extent_ = 0;
  CellGrid grid_;
  std::vector<Vec4> points_;
  Vec3 middle_{0};
  shared::BodyPose pose_;
};

/// The ball of a scene's tool; without points if the scene has no tool.
BoundaryBody ballBody(const MatterScene& scene, const MatterPlan& plan);

template <class Meet>
void BoundaryBody::forEachNear(const Vec3& place, Meet&& meet) const {
  if (!isNear(place)) return;
  const Vec3 seen = inBody(pose_, place);
  const float far = extent_ + support_;
  if (!(glm::dot(seen, seen) < far * far)) return;
  const Vec3 here = seen + middle_;
  grid_.forEachPlane(here, [&](std::uint32_t begin, std::uint32_t end) {
    // Without a branch for each point: about as many are near as not.
    std::array<std::uint32_t, 64> near;
    for (std::uint32_t first = begin; first < end; first += near.size()) {
      const auto last = std::min(end, first + static_cast<std::uint32_t>(near.size()));
      std::size_t count = 0;
      for (std::uint32_t k = first; k < last; ++k) {
        const Vec3 offset = here - Vec3(points_[k]);
        near[count] = k;
        count += glm::dot(offset, offset) < support_ * support_ ? 1 : 0;
      }
      for (const std::uint32_t k : std::span(near).first(count))
        meet(BoundaryMeeting{shared::bodyMeeting(pose_, place, here - Vec3(points_[k]), support_, points_[k].w), k});
    }
  });
}

}  // namespace palpate
