#pragma once

#include "engine/cloud/analytic_shape.hpp"
#include "engine/motion/rigid_motion.hpp"

namespace palpate {

/// Ground truth for a moving shape: the motion that MovingCloud applies to its sampling, in double precision.
class MovingShape {
 public:
  /// `origin`: of the sampled cloud; `motion` is relative to it. `shape` must outlive the object.
  MovingShape(const AnalyticShape& shape, const RigidMotion& motion, const DVec3& origin = DVec3(0))
      : shape_(shape), motion_(motion), origin_(origin) {}

  /// Distance to the surface at a time, positive outside. File coordinates.
  double signedDistance(const DVec3& place, double time_s) const {
    return shape_.signedDistance(origin_ + motion_.poseAt(time_s).movedBack(place - origin_));
  }

 private:
  const AnalyticShape& shape_;
  RigidMotion motion_;
  DVec3 origin_;
};

}  // namespace palpate
