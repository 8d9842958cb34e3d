#include "engine/contact/proxy_tracker.hpp"

#include <algorithm>
#include <cmath>

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
  const bool touched = touching_;
  if (!touching_) walkFreely(field, hip);
  if (touching_) track(field, hip, touched);
  if (!touching_) proxy_ = hip;
  started_ = true;
  lastHip_ = hip;
}

// The surface of the points of the face felt last. Beyond the edge of that sheet all points count.
SurfaceSample ProxyTracker::feel(const SurfaceField& field, const DVec3& x) {
  SurfaceSample sample = field.surface(x, facing_);
  if (!sample.defined && facing_ != DVec3(0)) sample = field.surface(x, DVec3(0));
  facing_ = sample.defined ? sample.normal : DVec3(0);
  if (touching_ && face_ == shared::kFaceBehind) {
    sample.normal = -sample.normal;
    sample.distance = -sample.distance;
  }
  return sample;
}

void ProxyTracker::walkFreely(const SurfaceField& field, const DVec3& hip) {
  const double longest = static_cast<double>(shared::kLongestStep) * radius_;
  const double way = glm::distance(lastHip_, hip) / longest;
  const shared::uint steps = shared::substepsOn(way);
  const bool traced = started_ && way <= static_cast<double>(shared::kMaxSubsteps);
  DVec3 before = lastHip_;
  for (shared::uint s = 1; s <= steps && !touching_; ++s) {
    const DVec3 x = glm::mix(lastHip_, hip, static_cast<double>(s) / steps);
    surface_ = feel(field, x);
    const bool inFront = surface_.distance > 0;
    if (surface_.defined && shared::crosses(face_, inFront)) {
      touching_ = true;
      sticks_ = true;
      proxy_ = before;
    } else {
      face_ = shared::faceAfter(face_, surface_.defined, surface_.ends, inFront, traced);
    }
    before = x;
  }
}

void ProxyTracker::track(const SurfaceField& field, const DVec3& hip, bool touched) {
  const double longest = static_cast<double>(shared::kLongestStep) * radius_;
  const double arrived = static_cast<double>(shared::kConvergence) * radius_;
  // The last tick evaluated the surface at the proxy: the first slide is along that surface.
  DVec3 firstSlide(0);
  if (touched && facing_ != DVec3(0))
    firstSlide =
        shared::slideAlong(face_ == shared::kFaceBehind ? -facing_ : facing_, proxy_ - hip, friction_, sticks_);
  auto tracking = shared::trackingFrom(firstSlide, sticks_, arrived);
  if (tracking.slid) proxy_ += shared::shortened(firstSlide, longest);
  surface_ = feel(field, proxy_);
  for (std::uint32_t steps = 0; steps < shared::kMaxTrackingSteps && surface_.defined; ++steps) {
    const auto step = shared::nextStep(tracking, proxy_ - hip, surface_.normal, surface_.distance, friction_);
    if (step.size < arrived) break;
    proxy_ += shared::takeStep(tracking, step, longest);
    if (step.size < static_cast<double>(shared::kLastStep) * radius_) break;
    surface_ = feel(field, proxy_);
  }
  sticks_ = !tracking.slid;
  if (!surface_.defined) {
    touching_ = false;
    face_ = shared::kFaceInside;  // lost inside: not caught again on the way out
  } else if (glm::dot(hip - proxy_, surface_.normal) > 0) {
    touching_ = false;
  }
  if (!touching_) surface_ = feel(field, hip);
}

}  // namespace palpate
