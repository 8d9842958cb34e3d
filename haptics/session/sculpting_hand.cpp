#include "haptics/session/sculpting_hand.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/cloud/voxel_sample.hpp"
#include "haptics/touch_target.hpp"

namespace palpate {

namespace {

constexpr std::size_t kPlaces = 16;  // where the brush is lowered
constexpr double kStrokeStep_mm = 0.5;
constexpr std::size_t kStepsApart = 6;

constexpr double kSpeed_mm_per_s = 50;  // as in a brisk stroke
constexpr double kSink = 1.0 / 8;       // of its radius: depth of a pressing brush in the surface
constexpr double kTau = 0.5,
                 kShallow =
                     1;  // spacings: depth that the surface resists (the yield depth); extra depth of a stroking brush
constexpr double kStrokeStrength = 0.5;
constexpr double kInflateDepth = 1.0 / 4;  // of its radius: deep enough that the hand never reaches the raised surface

// In support radii: height at which a landing begins, and distance per tick.
constexpr double kLift = 1.5, kLandingStep = 0.25;
constexpr std::uint32_t kPatience = 20;  // ticks without a surface before the hand moves elsewhere

constexpr double kGoldenAngle = 2.399963229728653;

// Depth of a brush below the resistance of the surface (the yield depth), model units.
double depthOf(BrushKind kind, double radius, double spacing) {
  if (brushHas(kind, shared::kHasShaft)) return kSink * radius;
  return brushHas(kind, shared::kRaisesSurface) ? std::max(kShallow * spacing, kInflateDepth * radius)
                                                : kShallow * spacing;
}

// Radius of the brush that reaches `count` points of the cloud at `place`, sunk into the surface by a fraction of its
// radius; 1: its centre is at `place`.
double radiusThatReaches(std::size_t count, const PointCloud& cloud, const SurfaceSpot& place, double sunk) {
  // A ball of radius r with its centre r (1 - sunk) above `place` contains x = place + d from the r on that solves |d -
  // r (1 - sunk) n| = r.
  const double above = 1 - sunk, rest = 1 - above * above;
  std::vector<double> least;
  least.reserve(cloud.size());
  for (const Vec3& position : cloud.positions) {
    const DVec3 d = DVec3(position) - place.position;
    const double b = above * glm::dot(d, place.normal);
    least.push_back((std::sqrt(b * b + rest * glm::dot(d, d)) - b) / rest);
  }
  const auto last = least.begin() + static_cast<std::ptrdiff_t>(std::min(count, least.size()) - 1);
  std::nth_element(least.begin(), last, least.end());
  return *last;
}

DVec3 across(const DVec3& heading, const DVec3& normal) {
  const DVec3 tangent = heading - glm::dot(heading, normal) * normal;
  const double length = glm::length(tangent);
  return length > 1e-9 ? tangent / length : frameAround(normal).u;
}

}  // namespace

WalkedSurface::WalkedSurface(const PointCloud& cloud, std::size_t most) : points(cloud, most) {
  const TouchTarget target = chooseTarget(ThinnedCloud(cloud, kCoarsePoints), coreBoundsOf(cloud));
  best = settle(points, target.position, target.normal);
}

std::vector<SurfaceSpot> sculptingPlaces(const Model& model, std::size_t most) {
  const WalkedSurface surface(model.cloud, most);
  const SurfaceSpot& first = surface.best;
  const Frame3 frame = frameAround(first.normal);
  std::vector<SurfaceSpot> places{first};
  for (std::size_t k = 1; k < kPlaces; ++k) {
    const double angle = kGoldenAngle * static_cast<double>(k);
    const auto way = walk(surface.points, first, std::cos(angle) * frame.u + std::sin(angle) * frame.v,
                          model.scale.toUnits(kStrokeStep_mm), k * kStepsApart);
    if (way.back().supported) places.push_back(way.back());
  }
  return places;
}

Stroke strokeWith(const BrushConfig& brush, const Model& model) {
  return {.brush = brush,
          .depth = model.scale.toUnits(brush.yieldDepth_mm) +
                   depthOf(brush.kind, model.scale.toUnits(brush.radius_mm), model.spacing),
          .speed = model.scale.toUnits(kSpeed_mm_per_s)};
}

Stroke strokeThatReaches(std::size_t touched, BrushKind kind, const Model& model, const SurfaceSpot& place,
                         double rate_Hz) {
  const double sunk = brushHas(kind, shared::kHasShaft) ? kSink : 1;
  const double radius = radiusThatReaches(touched, model.cloud, place, sunk);
  const double footprint = radius * std::sqrt(sunk * (2 - sunk));  // the brush's radius on flat ground
  const double speed = model.scale.toUnits(kSpeed_mm_per_s);
  const double ticksOnPlace = std::max(1.0, 2 * footprint / speed * rate_Hz);
  return strokeWith(
      {.kind = kind,
       .yieldDepth_mm = model.scale.toMm(kTau * model.spacing),
       .pushRate = 1 / ticksOnPlace,
       .radius_mm = model.scale.toMm(radius),
       .strength = brushHas(kind, shared::kHasShaft | shared::kPaintsPoints) ? 1 / ticksOnPlace : kStrokeStrength},
      model);
}

SculptingHand::SculptingHand(const Model& model, std::vector<SurfaceSpot> places, const Stroke& stroke, double reach)
    : origin_(model.cloud.origin), places_(std::move(places)), stroke_(stroke), reach_(reach) {
  putDown();
}

DeviceLimits SculptingHand::limits() const {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  return {.peakForce_N = kNone, .continuousForce_N = kNone, .fastest_mm_per_s = kNone, .handHeld = false};
}

void SculptingHand::putDown() noexcept {
  const SurfaceSpot& place = places_[landings_ % places_.size()];
  const double angle = kGoldenAngle * static_cast<double>(landings_++);
  const Frame3 frame = frameAround(place.normal);
  normal_ = place.normal;
  heading_ = std::cos(angle) * frame.u + std::sin(angle) * frame.v;
  hip_ = origin_ + place.position + kLift * reach_ * normal_;
  left_ = 2 * kLift * reach_ + stroke_.depth;
  depth_ = 0;
  lost_ = 0;
  contact_ = {};
}

DeviceState SculptingHand::read(double time_s) noexcept {
  const double dt_s = time_s - time_s_;
  time_s_ = time_s;
  const double down = kLandingStep * reach_;
  if (contact_.touching) {
    depth_ = std::min(stroke_.depth, depth_ + down);
    heading_ = across(heading_, normal_);
    hip_ = contact_.proxy + stroke_.speed * dt_s * heading_ - depth_ * normal_;
  } else if (depth_ == 0 && left_ > 0) {
    hip_ -= down * normal_;
    left_ -= down;
  } else if (left_ <= 0 || ++lost_ > kPatience) {
    putDown();
  }
  return {.position = hip_, .ok = true};
}

void SculptingHand::felt(const Contact& contact) noexcept {
  contact_ = contact;
  if (!contact.touching) return;
  lost_ = 0;
  if (glm::dot(contact.normal, contact.normal) > 0) normal_ = contact.normal;
}

}  // namespace palpate
