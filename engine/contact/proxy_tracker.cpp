#include "engine/contact/proxy_tracker.hpp"

#include "shaders/shared/proxy.h"

namespace palpate {

void ProxyTracker::follow(const SurfaceField& field, const DVec3& hip, double now_s, const PointsTime& points) {
  DVec3 age(0);  // displacement of the surface since the points' time
  if (started_ && velocity_ != DVec3(0)) {
    const PointsMotion motion = pointsMotion(now_s, points, time_s_);
    age = motion.age_s * velocity_;
    lastHip_ += motion.sinceLast_s * velocity_ - age;
    proxy_ += motion.sinceLast_s * velocity_ - age;
  }
  step(field, hip - age);
  velocity_ = surface_.defined ? field.velocity(touching_ ? proxy_ : hip - age, facing_) : DVec3(0);
  proxy_ = touching_ ? proxy_ + age : hip;
  lastHip_ = hip;
  time_s_ = now_s;
}

void ProxyTracker::step(const SurfaceField& field, const DVec3& hip) {
  if (!started_) lastHip_ = hip;
  const double way = glm::distance(lastHip_, hip) / (static_cast<double>(shared::kLongestStep) * radius_);
  const shared::uint substeps = shared::substepsOn(way);
  const bool traced = started_ && way <= static_cast<double>(shared::kMaxSubsteps);
  auto tick = shared::tickFrom(touching_, sticks_, face_, facing_, lastHip_, proxy_, hip, radius_, friction_);
  do {
    if (tick.purpose == shared::kWalks) tick.at = glm::mix(lastHip_, hip, static_cast<double>(tick.substep) / substeps);
    surface_ = feel(field, tick.at, tick.touching && tick.face == shared::kFaceBehind);
  } while (shared::goesOn(tick, surface_, hip, radius_, friction_, substeps, traced, false));
  touching_ = tick.touching;
  sticks_ = tick.sticking;
  face_ = tick.face;
  proxy_ = touching_ ? tick.proxy : hip;
  started_ = true;
  lastHip_ = hip;
}

// The surface of the points of the face felt last. Beyond the edge of that sheet all points count.
SurfaceSample ProxyTracker::feel(const SurfaceField& field, const DVec3& x, bool fromBehind) {
  SurfaceSample sample = field.surface(x, facing_);
  if (!sample.defined && facing_ != DVec3(0)) sample = field.surface(x, DVec3(0));
  facing_ = sample.defined ? sample.normal : DVec3(0);
  if (fromBehind) {
    sample.normal = -sample.normal;
    sample.distance = -sample.distance;
  }
  return sample;
}

}  // namespace palpate
