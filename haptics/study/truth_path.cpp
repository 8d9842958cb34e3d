#include "haptics/study/truth_path.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

namespace palpate {

namespace {

constexpr double kApproach_mm_per_s = 25, kRest_s = 0.05, kHold_s = 0.25;
constexpr double kStep_mm = 0.1;      // along a slide
constexpr double kEdgeCosine = 0.9;   // between the normals of neighbouring steps; below it the surface has an edge
constexpr double kNearEnough = 0.98;  // of the intended depth: if the true one is larger, the surface does not jump
constexpr double kMinDepth = 0.4;     // of the intended depth: at less, a force's direction means little
constexpr double kGivingWay = 0.5;    // maximum change of depth along the path, as a slope
constexpr int kTaps = 5;

/// Adds keys by target and speed.
class Keys {
 public:
  Keys(const DVec3& start, const ModelScale& scale) : scale_(scale), keys_{{0, start}} {}

  void moveTo(const DVec3& p, double speed_mm_per_s) {
    const double length_mm = scale_.toMm(glm::distance(p, keys_.back().position));
    constexpr double kShortest_mm = 1e-9;  // keys ascend strictly in time
    if (length_mm > kShortest_mm) keys_.push_back({now_s() + length_mm / speed_mm_per_s, p});
  }
  void rest(double time_s) { keys_.push_back({now_s() + time_s, keys_.back().position}); }
  double now_s() const { return keys_.back().t_s; }

  TruthPath path(double from_s, double to_s) && { return {Path(std::move(keys_)), from_s, to_s}; }

 private:
  ModelScale scale_;
  std::vector<PathKey> keys_;
};

DVec3 above(const SurfacePoint& spot, double height) { return spot.position + height * spot.normal; }

DVec3 unitTangent(const DVec3& direction, const DVec3& normal) {
  return glm::normalize(direction - glm::dot(direction, normal) * normal);
}

// Reduces the depth where another part of the surface would be nearer, without jumps and kinks in between.
void giveWay(const TouchTruth& truth, const std::vector<SurfacePoint>& spots, double mostChange,
             std::vector<double>& depths) {
  const double least = kMinDepth * depths.front();
  for (std::size_t k = 0; k < spots.size(); ++k)
    while (depths[k] > least && -truth.signedDistance(above(spots[k], -depths[k])) < kNearEnough * depths[k])
      depths[k] *= 0.9;
  for (std::size_t k = 1; k < depths.size(); ++k) depths[k] = std::min(depths[k], depths[k - 1] + mostChange);
  for (std::size_t k = depths.size(); k-- > 1;) depths[k - 1] = std::min(depths[k - 1], depths[k] + mostChange);
}

}  // namespace

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

TruthPath truthSlide(const TouchTruth& truth, const SurfacePoint& start, const DVec3& towards, const ModelScale& scale,
                     const TruthPathOptions& options) {
  const double lift = scale.toUnits(options.lift_mm), depth = scale.toUnits(options.depth_mm);
  const double step = scale.toUnits(kStep_mm);
  std::vector<SurfacePoint> spots{start};
  DVec3 heading = unitTangent(towards, start.normal);
  bool brokenOff = false;
  for (double gone_mm = kStep_mm; gone_mm < options.length_mm + 0.5 * kStep_mm; gone_mm += kStep_mm) {
    SurfacePoint spot = spots.back();
    const DVec3 ahead = spot.position + step * heading;
    const SurfacePoint next = truth.closest(ahead);
    brokenOff = brokenOff || glm::dot(next.normal, spot.normal) < kEdgeCosine;
    if (brokenOff) {
      spot.position = ahead;
    } else {
      spot = next;
      heading = unitTangent(heading, spot.normal);
    }
    spots.push_back(spot);
  }
  std::vector<double> depths(spots.size(), depth);
  if (!brokenOff) giveWay(truth, spots, kGivingWay * step, depths);
  Keys keys(above(start, lift), scale);
  keys.moveTo(above(start, -depths.front()), kApproach_mm_per_s);
  keys.rest(kRest_s);
  const double from_s = keys.now_s();
  for (std::size_t k = 1; k < spots.size(); ++k) keys.moveTo(above(spots[k], -depths[k]), options.speed_mm_per_s);
  const double to_s = keys.now_s();
  keys.moveTo(above(spots.back(), lift), kApproach_mm_per_s);
  return std::move(keys).path(from_s, to_s);
}

TruthPath truthPress(const SurfacePoint& start, const ModelScale& scale, const TruthPathOptions& options) {
  const double lift = scale.toUnits(options.lift_mm);
  Keys keys(above(start, lift), scale);
  keys.moveTo(above(start, -scale.toUnits(options.depth_mm)), options.speed_mm_per_s);
  keys.rest(kHold_s);
  const double to_s = keys.now_s();
  keys.moveTo(above(start, lift), kApproach_mm_per_s);
  return std::move(keys).path(to_s - 0.5 * kHold_s, to_s);
}

TruthPath truthTaps(const SurfacePoint& start, const ModelScale& scale, const TruthPathOptions& options) {
  const DVec3 lifted = above(start, scale.toUnits(options.lift_mm));
  Keys keys(lifted, scale);
  for (int tap = 0; tap < kTaps; ++tap) {
    keys.moveTo(above(start, -scale.toUnits(options.depth_mm)), options.speed_mm_per_s);
    keys.moveTo(lifted, options.speed_mm_per_s);
  }
  const double to_s = keys.now_s();
  return std::move(keys).path(0, to_s);
}

}  // namespace palpate
