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
  started_ = true;
  if (!touching_) walkFreely(field, hip);
  if (touching_) track(field, hip);
  if (!touching_) {
    proxy_ = hip;
    surface_ = field.surface(hip);
  }
  lastHip_ = hip;
}

void ProxyTracker::walkFreely(const SurfaceField& field, const DVec3& hip) {
  const double longest = static_cast<double>(shared::kLongestStep) * radius_;
  const double wanted = std::ceil(glm::distance(lastHip_, hip) / longest);
  const auto steps = static_cast<int>(std::clamp(wanted, 1.0, static_cast<double>(shared::kMaxSubsteps)));
  DVec3 outside = lastHip_;
  for (int s = 1; s <= steps && !touching_; ++s) {
    const DVec3 x = glm::mix(lastHip_, hip, static_cast<double>(s) / steps);
    const SurfaceSample sample = field.surface(x);
    if (!sample.defined) {
      side_ = shared::kSideUnknown;
    } else if (sample.distance > 0) {
      side_ = shared::kSideOutside;
      outside = x;
    } else if (side_ == shared::kSideOutside) {
      touching_ = true;
      proxy_ = outside;
    } else {
      side_ = shared::kSideInside;
    }
  }
}

void ProxyTracker::track(const SurfaceField& field, const DVec3& hip) {
  const double longest = static_cast<double>(shared::kLongestStep) * radius_;
  const double arrived = static_cast<double>(shared::kConvergence) * radius_;
  DVec3 lastSlide(0);
  double relaxation = 1;
  surface_ = field.surface(proxy_);
  for (std::uint32_t step = 0; step < shared::kMaxTrackingSteps && surface_.defined; ++step) {
    const DVec3 n = surface_.normal;
    const DVec3 lift = -surface_.distance * n;
    const DVec3 toHip = hip - proxy_;
    const DVec3 slide = toHip - glm::dot(toHip, n) * n;
    if (glm::length(lift) < arrived && glm::length(slide) < arrived) break;
    if (glm::dot(slide, lastSlide) < 0) relaxation *= 0.5;
    lastSlide = slide;
    proxy_ += shortened(lift, longest) + shortened(relaxation * slide, longest);
    surface_ = field.surface(proxy_);
  }
  if (!surface_.defined) {
    touching_ = false;
    side_ = shared::kSideUnknown;
  } else if (glm::dot(hip - proxy_, surface_.normal) > 0) {
    touching_ = false;
    side_ = shared::kSideOutside;
  }
}

}  // namespace palpate
