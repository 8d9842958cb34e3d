#include "haptics/truth_path.hpp"

#include <cmath>

namespace palpate {
namespace {

constexpr double kApproach_mm_per_s = 25, kRest_s = 0.05, kHold_s = 0.25;
constexpr double kStep_mm = 0.1;     // along a slide
constexpr double kEdgeCosine = 0.9;  // between the normals of neighbouring steps; below it the surface has an edge
constexpr int kTaps = 5;

/// Adds keys by where to go and how fast.
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

DVec3 tangent(const DVec3& direction, const DVec3& normal) {
  return glm::normalize(direction - glm::dot(direction, normal) * normal);
}

}  // namespace

TruthPath truthSlide(const TouchTruth& truth, const SurfacePoint& start, const DVec3& towards, const ModelScale& scale,
                     const TruthPathOptions& options) {
  const double lift = scale.toUnits(options.lift_mm), depth = scale.toUnits(options.depth_mm);
  const double step = scale.toUnits(kStep_mm);
  Keys keys(above(start, lift), scale);
  keys.moveTo(above(start, -depth), kApproach_mm_per_s);
  keys.rest(kRest_s);
  const double from_s = keys.now_s();
  SurfacePoint spot = start;
  DVec3 heading = tangent(towards, spot.normal);
  bool brokenOff = false;
  for (double gone_mm = kStep_mm; gone_mm < options.length_mm + 0.5 * kStep_mm; gone_mm += kStep_mm) {
    const DVec3 ahead = spot.position + step * heading;
    const SurfacePoint next = truth.closest(ahead);
    brokenOff = brokenOff || glm::dot(next.normal, spot.normal) < kEdgeCosine;
    if (brokenOff) {
      spot.position = ahead;
    } else {
      spot = next;
      heading = tangent(heading, spot.normal);
    }
    keys.moveTo(above(spot, -depth), options.speed_mm_per_s);
  }
  const double to_s = keys.now_s();
  keys.moveTo(above(spot, lift), kApproach_mm_per_s);
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
