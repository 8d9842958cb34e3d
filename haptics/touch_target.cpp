#include "haptics/touch_target.hpp"

#include <algorithm>
#include <limits>

namespace palpate {
namespace {

const DVec3 kTowardsViewer = glm::normalize(DVec3(0.35, 0.45, 0.82));  // the default camera: front, a little above
constexpr double kFacingViewer = 0.5;                                  // cosine of 60 degrees
constexpr std::size_t kCandidates = 800;
constexpr std::size_t kSurroundings = 96;  // maximum number of neighbours examined

// In shares of the longest side.
constexpr double kToolRadius = 0.04;
constexpr double kApproachFrom = 0.015, kApproachTo = 0.08;
constexpr double kSightWidth = 0.02, kSightTo = 1.5;

// On a plane the nearest point to a position on the normal is its foot, so a slope of 1 would require convexity; 0.7
// permits shallow hollows. Along a line of sight 60 degrees off the normal the distance to a plane has a slope of 0.5.
constexpr double kApproachSlope = 0.7, kSightSlope = 0.3;

constexpr double kBackFace = -0.3;  // cosine; a neighbour that faces away like this belongs to the back of a sheet

// Penalties, weighed against flatness (up to kFlatWorth), facing the viewer (up to kFacingWorth) and nearness to the
// middle (up to 1).
constexpr double kFlatWorth = 2, kFacingWorth = 1, kHidden = 3, kTwoSided = 4, kObstructed = 6, kFacingAway = 12;

struct Surroundings {
  DVec3 normal{0};
  double flatness = 0;  ///< mean cosine between the neighbours' normals and `normal`
  bool oneSided = true;
};

Surroundings surroundingsOf(const ThinnedCloud& sample, std::size_t candidate, double radius) {
  Surroundings result;
  const DVec3 own = sample.normal(candidate);
  const std::vector<NearPoint> neighbours = sample.nearest(sample.position(candidate), kSurroundings);
  for (const NearPoint& neighbour : neighbours) {
    if (neighbour.distance > radius) break;
    const DVec3 normal = sample.normal(neighbour.index);
    if (glm::dot(normal, own) > 0) result.normal += normal;
  }
  const double length = glm::length(result.normal);
  result.normal = length > 0 ? result.normal / length : own;

  std::size_t count = 0;
  for (const NearPoint& neighbour : neighbours) {
    if (neighbour.distance > radius) break;
    const double cosine = glm::dot(sample.normal(neighbour.index), result.normal);
    result.flatness += cosine;
    result.oneSided = result.oneSided && cosine > kBackFace;
    ++count;
  }
  if (count) result.flatness /= static_cast<double>(count);
  return result;
}

double scoreOf(const ThinnedCloud& sample, const Bounds& bounds, const DVec3& p, const Surroundings& around) {
  const double side = bounds.longestSide();
  const DVec3 offset = p - bounds.center();
  const DVec3 across = offset - glm::dot(offset, kTowardsViewer) * kTowardsViewer;
  double score = kFlatWorth * around.flatness;
  if (side > 0) score += 1 - glm::length(across) / (0.5 * side);
  if (!around.oneSided) score -= kTwoSided;
  if (!sample.isFree(p, around.normal, kApproachFrom * side, kApproachTo * side, kApproachSlope, kToolRadius * side))
    score -= kObstructed;
  const double facing = glm::dot(around.normal, kTowardsViewer);
  score += kFacingWorth * facing;
  if (facing < kFacingViewer)
    score -= kFacingAway;
  else if (!sample.isFree(p, kTowardsViewer, kToolRadius * side, kSightTo * side, kSightSlope, kSightWidth * side))
    score -= kHidden;
  return score;
}

}  // namespace

TouchTarget chooseTarget(const ThinnedCloud& sample, const Bounds& bounds) {
  TouchTarget best{sample.position(0), sample.normal(0)};
  double bestScore = -std::numeric_limits<double>::infinity();
  const double stride = std::max(1.0, static_cast<double>(sample.size()) / kCandidates);
  for (double at = 0; at < static_cast<double>(sample.size()); at += stride) {
    const auto candidate = static_cast<std::size_t>(at);
    const Surroundings around = surroundingsOf(sample, candidate, kToolRadius * bounds.longestSide());
    const double score = scoreOf(sample, bounds, sample.position(candidate), around);
    if (score <= bestScore) continue;
    bestScore = score;
    best = {sample.position(candidate), around.normal};
  }
  return best;
}

}  // namespace palpate
