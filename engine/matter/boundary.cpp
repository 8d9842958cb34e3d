#include "engine/matter/boundary.hpp"

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "engine/matter/matter_rules.hpp"

namespace palpate {

namespace {

// Points have no compression of their own, so matter under pressure comes nearer to them than to other matter, by this
// distance at any pressure: measured on balls of 3, 4 and 5 spacings, whose buoyancy was that of smaller ones.
constexpr double kNearer_spacings = 0.075;

// Depth to which water enters a ball that is moved abruptly before it is pushed out.
constexpr double kWithin_spacings = 0.5;
// In support radii per substep.
constexpr float kPush_supports = 0.05f;

double ballVolume(double radius) { return radius > 0 ? 4 * std::numbers::pi / 3 * radius * radius * radius : 0; }

// Points of equal area on a sphere, along a spiral by the golden angle (Vogel 1979).
void addShell(std::size_t count, double radius, double volume, std::vector<BoundaryPoint>& points) {
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
  for (std::size_t k = 0; k < count; ++k) {
    const double y = 1 - 2 * (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    const double across = std::sqrt(1 - y * y), angle = turn * static_cast<double>(k);
    points.push_back({.place = radius * DVec3(across * std::cos(angle), y, across * std::sin(angle)),
                      .volume = static_cast<float>(volume / static_cast<double>(count))});
  }
}

Vec3 extentOf(std::span<const BoundaryPoint> points) {
  Vec3 most{0};
  for (const BoundaryPoint& point : points) most = glm::max(most, glm::abs(point.place));
  return most;
}

}  // namespace

std::vector<BoundaryPoint> ballPoints(double radius_m, double spacing_m, double support_m) {
  std::vector<BoundaryPoint> points;
  const double cube = spacing_m * spacing_m * spacing_m, surface = radius_m + kNearer_spacings * spacing_m;
  for (double outer = surface; outer > 0 && outer > surface - support_m; outer -= spacing_m) {
    const double inner = std::max(outer - spacing_m, 0.0);
    const double volume = (ballVolume(outer) - ballVolume(inner)) / cube;
    const double radius = inner > 0 ? (outer + inner) / 2 : 0;
    const auto count = inner > 0 ? static_cast<std::size_t>(std::max(1.0, std::round(volume))) : std::size_t{1};
    addShell(count, radius, volume, points);
  }
  return points;
}

BoundaryBody::BoundaryBody(std::span<const BoundaryPoint> points, float support, float kept)
    : support_(support),
      kept_(kept),
      grid_(cellsOf({.size = 2.0f * extentOf(points) + support}, support)),
      middle_(extentOf(points) + 0.5f * support) {
  std::vector<Vec4> places;
  for (const BoundaryPoint& point : points) {
    places.emplace_back(point.place + middle_, point.volume);
    extent_ = std::max(extent_, glm::length(point.place));
  }
  WorkerTeam alone(1);
  grid_.sort(places, alone);
  for (const std::uint32_t k : grid_.order()) points_.push_back(places[k]);
}

BoundaryBody ballBody(const MatterScene& scene, const MatterPlan& plan) {
  const double support_m = kSupport_spacings * plan.spacing_m;
  const double radius_m = scene.tool.radius_mm * 1e-3;
  const double within_m = scene.matter == Matter::sand ? 0 : kWithin_spacings * plan.spacing_m;
  return {ballPoints(radius_m, plan.spacing_m, support_m), static_cast<float>(support_m),
          static_cast<float>(std::max(radius_m - within_m, 0.0))};
}

float BoundaryBody::push() const { return kPush_supports * support_; }

void BoundaryBody::moveTo(const BodyMotion& motion, double grown_m) {
  pose_ = {.place = motion.place,
           .velocity = motion.velocity,
           .spin = motion.spin,
           .turn = glm::mat3(glm::mat3_cast(glm::normalize(motion.orientation))),
           .grown = static_cast<float>(grown_m)};
}

}  // namespace palpate
