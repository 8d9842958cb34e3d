#include "haptics/study/touch_truth.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

namespace palpate {

TouchTruth truthOf(const AnalyticShape& shape) {
  return {.closest = [&shape](const DVec3& p) { return shape.closest(p); },
          .signedDistance = [&shape](const DVec3& p) { return shape.signedDistance(p); }};
}

TouchTruth truthOf(const TriangleMesh& mesh) {
  return {.closest = [&mesh](const DVec3& p) { return mesh.closest(p); },
          .signedDistance = [&mesh](const DVec3& p) { return mesh.signedDistance(p); }};
}

void GodObject::follow(const DVec3& hip) {
  if (!started_) lastHip_ = hip;
  started_ = true;
  const double pieces = std::max(1.0, std::ceil(glm::distance(lastHip_, hip) / longestStep_));
  for (double k = 1; k <= pieces; ++k) step(glm::mix(lastHip_, hip, k / pieces));
  if (!touching_) contact_ = truth_.closest(hip);
  lastHip_ = hip;
}

void GodObject::step(const DVec3& hip) {
  if (!touching_) {
    const bool inside = truth_.signedDistance(hip) <= 0;
    touching_ = inside && outside_;
    outside_ = !inside;
    if (touching_) contact_ = truth_.closest(hip);
  }
  if (!touching_) return;
  slide(hip);
  if (glm::dot(hip - contact_.position, contact_.normal) > 0) {
    touching_ = false;
    outside_ = true;
  }
}

// Steps towards the HIP in the tangent plane and back onto the surface. On a concave surface a step goes too far, by
// the depth over the radius of curvature; halving the steps after each reversal makes it converge.
void GodObject::slide(const DVec3& hip) {
  constexpr int kMaxSteps = 200;
  const double arrived = 2e-5 * longestStep_;
  DVec3 last(0);
  double share = 1;
  for (int step = 0; step < kMaxSteps; ++step) {
    const DVec3 toHip = hip - contact_.position;
    const DVec3 aside = toHip - glm::dot(toHip, contact_.normal) * contact_.normal;
    if (glm::dot(aside, last) < 0) share *= 0.5;
    last = aside;
    const double length = share * glm::length(aside);
    if (length < arrived) break;
    contact_ = truth_.closest(contact_.position + aside * (share * std::min(1.0, longestStep_ / length)));
  }
}

}  // namespace palpate
