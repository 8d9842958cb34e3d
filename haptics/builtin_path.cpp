#include "haptics/builtin_path.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "engine/cloud/voxel_sample.hpp"
#include "engine/core/error.hpp"
#include "engine/core/unknown_name.hpp"
#include "haptics/surface_walk.hpp"
#include "haptics/touch_target.hpp"

namespace palpate {
namespace {

constexpr std::array<std::string_view, 4> kNames{"press", "slide", "scan", "orbit"};

constexpr double kTouchSpeed_mm_per_s = 25;
constexpr double kTravelSpeed_mm_per_s = 50;
constexpr double kPressFrom_mm = 3, kPressHold_s = 0.25;
constexpr double kSlideDepth_mm = 1, kSlideStep_mm = 0.5, kSlideLength_mm = 20;
constexpr int kSlideDirections = 8;
constexpr int kScanSide = 5;
constexpr double kScanPitch_mm = 4, kScanDepth_mm = 1, kScanLift_mm = 2, kScanStep_mm = 0.5;
constexpr double kOrbitTime_s = 2, kOrbitRadius = 1.1;  // times half the diagonal in x and z
constexpr double kSmallestOrbit_mm = 5;                 // around a model without extent
constexpr int kOrbitKeys = 256;

// Points examined: the coarse sample chooses the position in well under a second, the fine one keeps the detail.
constexpr std::size_t kCoarse = 32'768, kFine = 524'288;

/// Adds keys by target and speed. Positions in model units relative to the cloud's origin.
class PathBuilder {
 public:
  PathBuilder(const DVec3& origin, const ModelScale& scale) : origin_(origin), scale_(scale) {}

  void startAt(const DVec3& p) { add(0, p); }

  void moveTo(const DVec3& p, double speed_mm_per_s) {
    const double length_mm = scale_.toMm(glm::distance(p, last_));
    constexpr double kShortest_mm = 1e-6;  // keys ascend strictly in time
    if (length_mm > kShortest_mm) add(keys_.back().t_s + length_mm / speed_mm_per_s, p);
  }

  void rest(double time_s) { add(keys_.back().t_s + time_s, last_); }
  void moveDuring(double time_s, const DVec3& p) { add(keys_.back().t_s + time_s, p); }

  Path path() && { return Path(std::move(keys_)); }

 private:
  void add(double t_s, const DVec3& p) {
    keys_.push_back({t_s, origin_ + p});
    last_ = p;
  }

  DVec3 origin_;
  ModelScale scale_;
  DVec3 last_{0};
  std::vector<PathKey> keys_;
};

/// A cloud with the position chosen on it.
struct Scene {
  const PointCloud& cloud;
  const ModelScale& scale;
  ThinnedCloud surface;
  SurfaceSpot target;

  Scene(const PointCloud& points, const ModelScale& modelScale)
      : cloud(points), scale(modelScale), surface(points, kFine) {
    const TouchTarget chosen = chooseTarget(ThinnedCloud(points, kCoarse), coreBoundsOf(points));
    target = settle(surface, chosen.position, chosen.normal);
  }

  DVec3 above(const SurfaceSpot& spot, double height_mm) const {
    return spot.position + scale.toUnits(height_mm) * spot.normal;
  }
};

Path press(const Scene& scene, double penetration_mm) {
  PathBuilder builder(scene.cloud.origin, scene.scale);
  builder.startAt(scene.above(scene.target, kPressFrom_mm));
  builder.moveTo(scene.above(scene.target, -penetration_mm), kTouchSpeed_mm_per_s);
  builder.rest(kPressHold_s);
  return std::move(builder).path();
}

/// Of several directions around the target, the one along which the surface continues, bends least and has room above
/// it.
std::vector<SurfaceSpot> slideWay(const Scene& scene) {
  constexpr auto kSteps = static_cast<std::size_t>(kSlideLength_mm / kSlideStep_mm);
  constexpr double kUnsupported = 4, kNoRoom = 1;  // per step, against a mean cosine of at most 1
  const double room = scene.scale.toUnits(kPressFrom_mm);
  const Frame3 frame = frameAround(scene.target.normal);
  std::vector<SurfaceSpot> best;
  double bestScore = 0;
  for (int k = 0; k < kSlideDirections; ++k) {
    const double angle = 2 * std::numbers::pi * k / kSlideDirections;
    std::vector<SurfaceSpot> spots =
        walk(scene.surface, scene.target, std::cos(angle) * frame.u + std::sin(angle) * frame.v,
             scene.scale.toUnits(kSlideStep_mm), kSteps);
    double score = 0;
    for (const SurfaceSpot& spot : spots) {
      score += glm::dot(spot.normal, scene.target.normal);
      if (!spot.supported) score -= kUnsupported;
      if (scene.surface.distanceTo(spot.position + room * spot.normal) < 0.5 * room) score -= kNoRoom;
    }
    if (!best.empty() && score <= bestScore) continue;
    bestScore = score;
    best = std::move(spots);
  }
  return best;
}

Path slide(const Scene& scene) {
  PathBuilder builder(scene.cloud.origin, scene.scale);
  builder.startAt(scene.above(scene.target, kPressFrom_mm));
  builder.moveTo(scene.above(scene.target, -kSlideDepth_mm), kTouchSpeed_mm_per_s);
  for (const SurfaceSpot& spot : slideWay(scene))
    builder.moveTo(scene.above(spot, -kSlideDepth_mm), kTouchSpeed_mm_per_s);
  return std::move(builder).path();
}

SurfaceSpot scanSpot(const Scene& scene, int column, int row) {
  const Frame3 frame = frameAround(scene.target.normal);
  const double middle = 0.5 * (kScanSide - 1);
  const DVec3 offset_mm = kScanPitch_mm * ((column - middle) * frame.u + (row - middle) * frame.v);
  const double length_mm = glm::length(offset_mm);
  const auto steps = static_cast<std::size_t>(std::ceil(length_mm / kScanStep_mm));
  if (steps == 0) return scene.target;
  const double step = scene.scale.toUnits(length_mm) / static_cast<double>(steps);
  return walk(scene.surface, scene.target, offset_mm, step, steps).back();
}

Path scan(const Scene& scene) {
  PathBuilder builder(scene.cloud.origin, scene.scale);
  for (int row = 0; row < kScanSide; ++row) {
    for (int k = 0; k < kScanSide; ++k) {
      const int column = row % 2 == 0 ? k : kScanSide - 1 - k;  // back and forth
      const SurfaceSpot spot = scanSpot(scene, column, row);
      const DVec3 lifted = scene.above(spot, kScanLift_mm);
      if (row == 0 && k == 0)
        builder.startAt(lifted);
      else
        builder.moveTo(lifted, kTravelSpeed_mm_per_s);
      builder.moveTo(scene.above(spot, -kScanDepth_mm), kTouchSpeed_mm_per_s);
      builder.moveTo(lifted, kTouchSpeed_mm_per_s);
    }
  }
  return std::move(builder).path();
}

Path orbit(const PointCloud& cloud, const ModelScale& scale) {
  if (cloud.empty()) throw Error("the model has no points; there is nothing to go around");
  const Bounds bounds = coreBoundsOf(cloud);
  const double halfDiagonal = 0.5 * std::hypot(bounds.max.x - bounds.min.x, bounds.max.z - bounds.min.z);
  const double radius = std::max(kOrbitRadius * halfDiagonal, scale.toUnits(kSmallestOrbit_mm));
  const auto around = [&](int k) {
    const double angle = 2 * std::numbers::pi * k / kOrbitKeys;
    return bounds.center() + radius * DVec3(std::sin(angle), 0, std::cos(angle));  // starts in front
  };
  PathBuilder builder(cloud.origin, scale);
  builder.startAt(around(0));
  for (int k = 1; k <= kOrbitKeys; ++k) builder.moveDuring(kOrbitTime_s / kOrbitKeys, around(k % kOrbitKeys));
  return std::move(builder).path();
}

constexpr std::array<std::string_view, 2> kNamesInMatter{"press", "stir"};
constexpr double kDiveSpeed_mm_per_s = 100, kDiveFrom_mm = 5, kDiveHold_s = 1;
constexpr int kStirTurns = 4, kStirKeys = 64;
constexpr double kStirTurn_s = 1,
                 kStirRadius = 0.5;  // of the distance from the middle to the ball's wall contact

double extentAlong(const Bounds& box, const DVec3& direction) {
  return glm::dot(box.max - box.min, glm::abs(direction));
}

/// From a position clear of the matter to one where the ball is submerged, or on the ground.
struct Dive {
  DVec3 from, to;
};
Dive diveInto(const MatterPlace& place, const ModelScale& scale, double penetration_mm) {
  const DVec3 top = place.fill.center() + 0.5 * extentAlong(place.fill, place.up) * place.up;
  const double deepest = std::max(extentAlong(place.fill, place.up) - place.ballRadius, 0.0);
  const double deep = std::min(place.ballRadius + scale.toUnits(penetration_mm), deepest);
  return {top + (place.ballRadius + scale.toUnits(kDiveFrom_mm)) * place.up, top - deep * place.up};
}

}  // namespace

Path builtinPathInMatter(std::string_view name, const MatterPlace& place, const ModelScale& scale,
                         double penetration_mm) {
  if (std::find(kNamesInMatter.begin(), kNamesInMatter.end(), name) == kNamesInMatter.end())
    throw UsageError("{}", unknownName("built-in path in matter", name, kNamesInMatter));
  const Dive dive = diveInto(place, scale, penetration_mm);
  PathBuilder builder(DVec3(0), scale);
  builder.startAt(dive.from);
  builder.moveTo(dive.to, kDiveSpeed_mm_per_s);
  if (name == "press") {
    builder.rest(kDiveHold_s);
    return std::move(builder).path();
  }
  const Frame3 frame = frameAround(place.up);
  const double room = 0.5 * std::min(extentAlong(place.fill, frame.u), extentAlong(place.fill, frame.v));
  const double radius = kStirRadius * std::max(room - place.ballRadius, 0.0);
  const auto around = [&](int key) {
    const double angle = 2 * std::numbers::pi * key / kStirKeys;
    return dive.to + radius * (std::cos(angle) * frame.u + std::sin(angle) * frame.v);
  };
  builder.moveTo(around(0), kDiveSpeed_mm_per_s);
  for (int key = 1; key <= kStirTurns * kStirKeys; ++key) builder.moveDuring(kStirTurn_s / kStirKeys, around(key));
  builder.moveTo(dive.to, kDiveSpeed_mm_per_s);
  builder.moveTo(dive.from, kDiveSpeed_mm_per_s);
  return std::move(builder).path();
}

std::span<const std::string_view> builtinPathNames() { return kNames; }

Path builtinPath(std::string_view name, const PointCloud& cloud, const ModelScale& scale, double penetration_mm) {
  if (std::find(kNames.begin(), kNames.end(), name) == kNames.end())
    throw UsageError("{}", unknownName("built-in path", name, kNames));
  if (!(penetration_mm > 0) || !std::isfinite(penetration_mm))
    throw UsageError("a penetration of {} mm: it must be above 0", penetration_mm);
  if (name == "orbit") return orbit(cloud, scale);
  const Scene scene(cloud, scale);
  if (name == "slide") return slide(scene);
  if (name == "scan") return scan(scene);
  return press(scene, penetration_mm);
}

}  // namespace palpate
