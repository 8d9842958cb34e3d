#include "engine/study/edit_judge.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <unordered_set>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/check.hpp"
#include "engine/study/edit_aftermath.hpp"

namespace palpate {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr std::size_t kFirstDisc = 4, kLastDisc = 16;  // neighbours whose discs give a point's area
constexpr std::size_t kOfAPlace = 6;                   // number of points whose mean spacing is the local spacing
constexpr std::size_t kTangentPlanes = 4;
constexpr double kOnGround = 0.4;  // local spacings: maximum distance from a point before, on its surface
constexpr double kStep = 2;        // in spacings: maximum step from one point of a sheet to the next
constexpr double kSided = 0.3;     // minimum cosine between fit and known side for the fit's side to be known

// The algebraic sphere that fits positions and normals (Guennebaud, Germann and Gross 2008, "Dynamic sampling and
// rendering of algebraic point set surfaces", section 3), relative to a local origin.
class SphereFit {
 public:
  void add(const DVec3& p, const DVec3& n, double w) {
    weights_ += w, places_ += w * p, normals_ += w * n;
    squares_ += w * glm::dot(p, p), heights_ += w * glm::dot(p, n);
  }
  double height(const DVec3& x) const {
    const double spread = squares_ - glm::dot(places_, places_) / weights_;
    const double bend = heights_ - glm::dot(places_, normals_) / weights_;
    const double q = spread > 0 ? 0.5 * bend / spread : 0;
    const DVec3 l = (normals_ - 2 * q * places_) / weights_;
    const double c = -(glm::dot(l, places_) + q * squares_) / weights_;
    const double root = std::sqrt(std::max(0.0, glm::dot(l, l) - 4 * q * c));
    const double slope = glm::length(l + 2 * q * x) + root;
    return slope > 0 ? 2 * (c + glm::dot(l, x) + q * glm::dot(x, x)) / slope : 0;
  }

 private:
  double weights_ = 0, squares_ = 0, heights_ = 0;
  DVec3 places_{0}, normals_{0};
};

double wendlandWeight(double r) { return r < 1 ? std::pow(1 - r, 4) * (4 * r + 1) : 0; }

void judgeNormals(const EditAftermath& aftermath, const PointCloud& before, EditVerdict& verdict) {
  std::vector<double> angles;
  for (const std::uint32_t i : aftermath.there()) {
    if (!aftermath.isNew(i) && !aftermath.moved(i)) {
      verdict.turnedAtRest += glm::dot(aftermath.normal(i), DVec3(before.normals[i])) < 0;
      continue;
    }
    const std::optional<DVec3> fit = aftermath.fit(i);
    if (!fit) continue;
    const double angle = angleBetween_deg(*fit, aftermath.normal(i));
    angles.push_back(std::min(angle, 180 - angle));
    const double side = glm::dot(*fit, aftermath.facing(i));
    if (std::abs(side) <= kSided) continue;
    ++verdict.sided;
    verdict.turned += glm::dot(aftermath.normal(i), side > 0 ? *fit : -*fit) < 0;
  }
  verdict.fitted = angles.size();
  if (angles.empty()) return;
  const auto p95 = angles.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(angles.size() - 1));
  std::ranges::nth_element(angles, p95);
  verdict.normal_deg = *p95;
}

// How deep and how high a stroke has gone, and whether it has folded the surface over.
void judgeShape(const EditAftermath& aftermath, EditJudge& judge, const BrushPath& way, EditVerdict& verdict) {
  std::vector<Vec3> places;
  std::vector<std::uint32_t> changed, near;
  for (const std::uint32_t i : aftermath.there())
    if (aftermath.isNew(i) || aftermath.moved(i)) {
      changed.push_back(i);
      places.emplace_back(aftermath.position(i));
    }
  verdict.changed = changed.size();
  const PointTree tree(places);
  for (const std::uint32_t i : changed) {
    const DVec3 place = aftermath.position(i);
    const double height = judge.heightAt(place);
    verdict.deepest = std::max(verdict.deepest, -height);
    verdict.highest = std::max(verdict.highest, height);
    near.clear();
    const double spacing = judge.spacingAt(place, aftermath.facing(i));
    tree.near(place, 0.5 * spacing, near);
    // The two sides of a thin part, carried along together, are as they were.
    verdict.doubled += std::ranges::any_of(near, [&](std::uint32_t k) {
      return glm::dot(aftermath.normal(changed[k]), aftermath.normal(i)) < -kSided &&
             !aftermath.wereTwoSides(i, changed[k], spacing);
    });
  }
  verdict.reachSlack = way.reachSlack;
  if (way.depth)
    verdict.wrongDepth = std::abs(verdict.deepest - *way.depth) > EditTolerance::kDepth * *way.depth + way.depthSlack;
  if (way.mostRaised) verdict.raised = verdict.highest > *way.mostRaised;
}

}  // namespace

double distanceToWay(const DVec3& place, std::span<const DVec3> centers) {
  if (centers.empty()) return kFar;
  double least = glm::distance(place, centers.front());
  for (std::size_t k = 1; k < centers.size(); ++k) {
    const DVec3 step = centers[k] - centers[k - 1], offset = place - centers[k - 1];
    const double squared = glm::dot(step, step);
    const double along = squared > 0 ? std::clamp(glm::dot(offset, step) / squared, 0.0, 1.0) : 0;
    least = std::min(least, glm::length(offset - along * step));
  }
  return least;
}

EditJudge::EditJudge(const PointCloud& before) : before_(before), tree_(before.positions), spacings_(before.size()) {
  PALPATE_CHECK(before.hasNormals());
}

double EditJudge::spacingOf(std::uint32_t point) {
  double& spacing = spacings_[point];
  if (spacing > 0) return spacing;
  const NearestPoints near = nearestTo(tree_, position(point));
  double areas = 0;
  std::size_t discs = 0;
  std::vector<Vec3> places{before_.positions[point]};  // coincident points count once
  for (std::size_t i = 0; i < near.count && places.size() <= kLastDisc; ++i) {
    const Vec3& place = before_.positions[near.points[i]];
    if (glm::dot(normal(near.points[i]), normal(point)) <= 0 || std::ranges::find(places, place) != places.end())
      continue;
    places.push_back(place);
    if (places.size() <= kFirstDisc) continue;
    // The disc to the k-th neighbour holds k areas where points lie at random, k + 1/2 where they lie on a lattice.
    areas += std::numbers::pi * near.squared[i] / (static_cast<double>(places.size() - 1) + 0.25);
    ++discs;
  }
  spacing = discs > 0 ? std::sqrt(areas / static_cast<double>(discs)) : kFar;  // a single point cannot be crowded
  return spacing;
}

double EditJudge::spacingAt(const DVec3& place, const DVec3& facing) {
  const NearestPoints near = nearestTo(tree_, place);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < near.count && count < kOfAPlace; ++i) {
    if (glm::dot(normal(near.points[i]), facing) <= 0) continue;
    sum += spacingOf(near.points[i]);
    ++count;
  }
  if (count == 0 && near.count > 0) return spacingOf(near.points[0]);
  return count > 0 ? sum / static_cast<double>(count) : kFar;
}

// A position close to one of the points before, relative to their spacing, is on their surface. A position deep in a
// dent or a tunnel is not, and the points near it by chance may be sparse: there the spacing of its ancestor applies.
double EditJudge::spacingFor(const DVec3& place, std::uint32_t ancestor) {
  const double here = spacingAt(place, normal(ancestor));
  const NearestPoints near = nearestTo(tree_, place);
  std::size_t k = 0;
  while (k < near.count && glm::dot(normal(near.points[k]), normal(ancestor)) <= 0) ++k;
  const bool onGround = k < near.count && std::sqrt(near.squared[k]) <= kOnGround * here;
  return onGround ? here : std::min(here, spacingOf(ancestor));
}

double EditJudge::heightAt(const DVec3& place) const { return heightOver({tree_, {}}, place); }

double EditJudge::heightOver(const Sheet& sheet, const DVec3& place) const {
  const NearestPoints toPlace = nearestTo(sheet.tree, place);
  if (toPlace.count == 0) return kFar;
  const std::uint32_t first = sheet.numberOf(toPlace.points[0]);
  const DVec3 middle = position(first), facing = normal(first);
  const auto sameSheet = [&](std::uint32_t i) { return glm::dot(normal(i), facing) > -kSided; };
  const NearestPoints around = nearestTo(sheet.tree, middle);
  const double reach = 1.2 * std::sqrt(around.squared[std::min(kOfAFit, around.count) - 1]);
  SphereFit sphere;
  for (std::size_t k = 0; k < around.count; ++k) {
    const std::uint32_t i = sheet.numberOf(around.points[k]);
    const double r = reach > 0 ? std::sqrt(around.squared[k]) / reach : 0;
    if (sameSheet(i)) sphere.add(position(i) - middle, normal(i), wendlandWeight(r));
  }
  double highest = -kFar, own = 0;
  for (std::size_t k = 0, planes = 0; k < toPlace.count && planes < kTangentPlanes; ++k) {
    const std::uint32_t i = sheet.numberOf(toPlace.points[k]);
    if (!sameSheet(i)) continue;
    highest = std::max(highest, glm::dot(place - position(i), normal(i)));
    own = std::max(own, sphere.height(position(i) - middle));
    ++planes;
  }
  return std::min(sphere.height(place - middle) - own, highest);
}

// A new point above the nearest surface is not outside if that surface is a different sheet, such as the floor under a
// roof: the sheet around its ancestor counts, connected from point to point. Outgrowths start on that sheet.
double EditJudge::heightFrom(const DVec3& place, std::uint32_t ancestor, double least, double support) {
  const double height = heightAt(place);
  if (height <= least) return height;
  std::vector<std::uint32_t> sheet{ancestor}, found;
  std::unordered_set<std::uint32_t> known{ancestor};
  for (std::size_t next = 0; next < sheet.size(); ++next) {
    const std::uint32_t from = sheet[next];
    found.clear();
    tree_.near(position(from), std::min(support, kStep * spacingOf(from)), found);
    for (const std::uint32_t i : found) {
      const bool goesOn =
          glm::dot(normal(i), normal(from)) > 0 && glm::distance(position(i), position(ancestor)) < kKin * support;
      if (goesOn && known.insert(i).second) sheet.push_back(i);
    }
  }
  std::vector<Vec3> positions;
  positions.reserve(sheet.size());
  for (const std::uint32_t i : sheet) positions.push_back(before_.positions[i]);
  const PointTree tree(positions);
  return std::min(height, heightOver({tree, sheet}, place));
}

EditVerdict EditJudge::judge(std::span<const PointState> after, const BrushPath& way) {
  PALPATE_CHECK_LE(before_.size(), after.size());
  EditVerdict verdict{.farthestMoved = -way.radius / way.support,
                      .farthestInserted = -way.radius / way.support,
                      .farthestOutside = -kFar};
  const auto beyond = [&](const DVec3& place) {
    return (distanceToWay(place, way.centers) - way.radius) / way.support;
  };
  const EditAftermath aftermath(before_, tree_, after, way);
  for (std::uint32_t i = 0; i < before_.size(); ++i) {
    const bool gone = after[i].gone(), moved = !gone && aftermath.moved(i);
    verdict.removed += gone;
    verdict.moved += moved;
    const bool painted = !gone && after[i].color != packedColor(before_, i);
    verdict.painted += painted;
    if (gone || moved || painted) verdict.farthestMoved = std::max(verdict.farthestMoved, beyond(position(i)));
  }
  for (const std::uint32_t i : aftermath.there()) {
    if (!aftermath.isNew(i)) continue;
    ++verdict.inserted;
    const DVec3 place = aftermath.position(i);
    verdict.farthestInserted = std::max(verdict.farthestInserted, beyond(place));
    const double spacing = spacingFor(place, aftermath.ancestorOf(i));
    if (spacing == kFar) continue;  // a single point had no surface around it
    const double nearest = aftermath.nearestOfSheet(i, spacing) / spacing;
    // Points are also too close by the spacing of their ancestor's surface.
    const double finest = std::min(spacing, spacingOf(aftermath.ancestorOf(i)));
    verdict.nearest = std::min(verdict.nearest, nearest * spacing / finest);
    verdict.crowded += nearest < EditTolerance::kCrowded;
    const double height = heightFrom(place, aftermath.ancestorOf(i), EditTolerance::kOutside * spacing, way.support);
    verdict.farthestOutside = std::max(verdict.farthestOutside, height / way.support);
    verdict.outside += height > EditTolerance::kOutside * spacing;
  }
  if (verdict.farthestOutside == -kFar) verdict.farthestOutside = 0;
  judgeNormals(aftermath, before_, verdict);
  judgeShape(aftermath, *this, way, verdict);
  return verdict;
}

std::vector<std::string_view> EditVerdict::broken(bool carves, bool strict) const {
  const double reach = strict ? 0 : EditTolerance::kReach + reachSlack;
  const auto tooMany = [&](std::size_t part, std::size_t all, double most) {
    return strict ? part > 0 : part > 1 && static_cast<double>(part) > most * static_cast<double>(all);
  };
  std::vector<std::string_view> broken;
  if (farthestMoved > reach) broken.emplace_back("moves far");
  if (inserted > 0 && farthestInserted > 1 + reach) broken.emplace_back("inserts far");
  if (nearest < EditTolerance::kNearest || tooMany(crowded, inserted, EditTolerance::kMaxCrowded))
    broken.emplace_back("crowds");
  if (carves && tooMany(outside, inserted, EditTolerance::kMaxOutside)) broken.emplace_back("grows");
  if (tooMany(turned, sided, EditTolerance::kMaxTurned)) broken.emplace_back("turns normals");
  if (wrongDepth) broken.emplace_back("wrong depth");
  if (raised) broken.emplace_back("raises");
  if (tooMany(doubled, changed, EditTolerance::kMaxDoubled)) broken.emplace_back("second layer");
  if (turnedAtRest > 0) broken.emplace_back("turns normals at rest");
  return broken;
}

}  // namespace palpate
