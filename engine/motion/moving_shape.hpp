#pragma once

#include "engine/cloud/analytic_shape.hpp"
#include "engine/motion/rigid_motion.hpp"

namespace palpate {

/// The truth about a shape that moves: what MovingCloud does to a sampling of it, in double precision.
class MovingShape {
 public:
  /// `origin`: of the sampled cloud, which `motion` is relative to. `shape` must outlive it.
  MovingShape(const AnalyticShape& shape, const RigidMotion& motion, const DVec3& origin = DVec3(0))
      : shape_(shape), motion_(motion), origin_(origin) {}

  /// At a time, in file coordinates: distance to the surface, positive outside.
  double signedDistance(const DVec3& place, double time_s) const {
    return shape_.signedDistance(origin_ + motion_.poseAt(time_s).movedBack(place - origin_));
  }

 private:
  const AnalyticShape& shape_;
  RigidMotion motion_;
  DVec3 origin_;
};

}  // namespace palpate
