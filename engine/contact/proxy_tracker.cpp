#include "engine/contact/proxy_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "shaders/shared/contact.h"

namespace palpate {

namespace {

DVec3 shortened(const DVec3& step, double longest) {
  const double size = glm::length(step);
  return size > longest ? step * (longest / size) : step;
}

}  // namespace

void ProxyTracker::follow(const SurfaceField& field, const DVec3& hip) {
  if (!started_) lastHip_ = hip;
  const bool touched = touching_;
  if (!touching_) walkFreely(field, hip);
  if (touching_) track(field, hip, touched);
  if (!touching_) proxy_ = hip;
  started_ = true;
  lastHip_ = hip;
}

// The surface of the points that face the side felt last. Past the edge of such a sheet every point counts.
SurfaceSample ProxyTracker::feel(const SurfaceField& field, const DVec3& x) {
  SurfaceSample sample = field.surface(x, facing_);
  if (!sample.defined && facing_ != DVec3(0)) sample = field.surface(x, DVec3(0));
  facing_ = sample.defined ? sample.normal : DVec3(0);
  if (touching_ && side_ == shared::kSideBehind) {
    sample.normal = -sample.normal;
    sample.distance = -sample.distance;
  }
  return sample;
}

void ProxyTracker::walkFreely(const SurfaceField& field, const DVec3& hip) {
  const double longest = static_cast<double>(shared::kLongestStep) * radius_;
  const double most = static_cast<double>(shared::kMaxSubsteps), wanted = glm::distance(lastHip_, hip) / longest;
  const auto steps = static_cast<int>(std::clamp(std::ceil(wanted), 1.0, most));
  const bool traced = started_ && wanted <= most;
  DVec3 before = lastHip_;
  for (int s = 1; s <= steps && !touching_; ++s) {
    const DVec3 x = glm::mix(lastHip_, hip, static_cast<double>(s) / steps);
    surface_ = feel(field, x);
    const bool inFront = surface_.distance > 0;
    if (!surface_.defined) {
      if (side_ != shared::kSideInside) side_ = shared::kSideUnknown;
    } else if ((inFront && side_ == shared::kSideBehind) || (!inFront && side_ == shared::kSideOutside)) {
      touching_ = true;
      sticks_ = true;
      proxy_ = before;
    } else if (inFront) {
      side_ = shared::kSideOutside;
    } else if (side_ == shared::kSideUnknown) {
      side_ = traced ? shared::kSideBehind : shared::kSideInside;
    }
    before = x;
  }
}

// The part of a slide that friction leaves: the proxy is held while the force stays in the cone, and dragged along its
// border once it has left it.
DVec3 ProxyTracker::againstFriction(const DVec3& slide, double depth) {
  const double size = glm::length(slide);
  const double held = friction_ * std::max(0.0, depth);
  if (size <= (sticks_ ? static_cast<double>(shared::kStaticFriction) * held : held)) return DVec3(0);
  return slide * (1.0 - held / size);
}

void ProxyTracker::track(const SurfaceField& field, const DVec3& hip, bool touched) {
  const double longest = static_cast<double>(shared::kLongestStep) * radius_;
  const double arrived = static_cast<double>(shared::kConvergence) * radius_;
  const auto slideAlong = [&](const DVec3& n) {
    const DVec3 toHip = hip - proxy_;
    const double depth = -glm::dot(toHip, n);
    return againstFriction(toHip + depth * n, depth);
  };
  double relaxation = 1;
  // Where the proxy stands the last tick has felt the surface: the first slide goes along that one.
  DVec3 lastSlide(0);
  if (touched && facing_ != DVec3(0)) lastSlide = slideAlong(side_ == shared::kSideBehind ? -facing_ : facing_);
  bool slid = glm::length(lastSlide) >= arrived;
  if (slid) {
    sticks_ = false;
    proxy_ += shortened(lastSlide, longest);
  }
  surface_ = feel(field, proxy_);
  for (std::uint32_t step = 0; step < shared::kMaxTrackingSteps && surface_.defined; ++step) {
    const DVec3 lift = -surface_.distance * surface_.normal;
    const DVec3 slide = slideAlong(surface_.normal);
    const double size = std::max(glm::length(lift), relaxation * glm::length(slide));
    if (size < arrived) break;
    // A slide that turns back has overshot, as it does in a hollow narrower than the HIP is deep.
    if (glm::dot(slide, lastSlide) < 0) relaxation *= 0.5;
    lastSlide = slide;
    if (slide != DVec3(0)) {
      slid = true;
      sticks_ = false;
    }
    proxy_ += shortened(lift, longest) + shortened(relaxation * slide, longest);
    if (size < static_cast<double>(shared::kLastStep) * radius_) break;
    surface_ = feel(field, proxy_);
  }
  sticks_ = !slid;
  if (!surface_.defined) {
    touching_ = false;
    side_ = shared::kSideInside;  // lost within: not caught again on the way out
  } else if (glm::dot(hip - proxy_, surface_.normal) > 0) {
    touching_ = false;
  }
  if (!touching_) surface_ = feel(field, hip);
}

}  // namespace palpate
