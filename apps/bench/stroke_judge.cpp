#include "apps/bench/stroke_judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>

#include "engine/cloud/eigen3.hpp"
#include "engine/study/edit_aftermath.hpp"

namespace palpate {

namespace {

constexpr std::array<std::string_view, 8> kCriteria{"raised", "turned",  "points",   "shreds",
                                                    "deep",   "shallow", "far side", "fold"};
constexpr double kNearby = 2.5;  // local spacings: neighbours of a point
constexpr std::size_t kMinNeighbours = 3, kOfAPlane = 10, kOfAFlake = 6;
constexpr double kFlake = 1;  // local spacings off the plane of the neighbours
constexpr double kSame = 0.3, kAway = -0.8, kThrough = -0.3;
constexpr double kThin = 2, kOtherSide = -0.5, kInPlane = 0.35;
constexpr double kPair = 1.6, kMinPair = 0.5, kFlip = -0.1;

// A cloud at one moment: the points of the region and enough around them.
struct Sheet {
  std::vector<Vec3> places;
  std::vector<DVec3> normals;
  std::vector<double> spacings;
  std::vector<char> inRegion, rests;  // rests: unchanged by the stroke
  std::vector<char> isThin;           // before the stroke another side was as near as the neighbours
};

struct Faults {
  std::size_t region = 0, turned = 0, shreds = 0;
};

struct Edge {
  double cost;
  std::uint32_t from, to;
  bool operator>(const Edge& other) const { return cost > other.cost; }
};

// Orientations spread from the points at rest along the surface; counts the points whose normal contradicts them.
Faults faultsOf(const Sheet& sheet) {
  const PointTree tree(sheet.places);
  const std::size_t count = sheet.places.size();
  const auto place = [&](std::size_t i) { return DVec3(sheet.places[i]); };
  std::vector<DVec3> fits(count, DVec3(0));
  std::vector<std::vector<std::uint32_t>> neighbours(count);
  Faults faults;
  for (std::uint32_t i = 0; i < count; ++i) {
    const NearestPoints near = nearestTo(tree, place(i));
    const double h = sheet.spacings[i];
    std::size_t close = 0, flakes = 0, kin = 0;
    DVec3 mean(0);
    std::vector<std::uint32_t>& list = neighbours[i];
    for (std::size_t k = 0; k < near.count; ++k) {
      const std::uint32_t j = near.points[k];
      if (j == i) continue;
      const double distance = std::sqrt(near.squared[k]);
      if (distance > 4 * h) break;
      close += distance <= kNearby * h;
      if (list.size() < kOfAPlane) list.push_back(j);
      if (kin < kOfAFlake && glm::dot(sheet.normals[i], sheet.normals[j]) > kSame) {
        ++kin;
        flakes += std::abs(glm::dot(place(j) - place(i), sheet.normals[i])) > kFlake * h;
      }
    }
    if (sheet.inRegion[i]) {
      ++faults.region;
      faults.shreds += close < kMinNeighbours || 2 * flakes > kOfAFlake || kin < kMinNeighbours;
    }
    if (sheet.isThin[i]) {
      // No direction can be spread over two sides that are nearer to each other than their points: the majority of the
      // neighbours in the point's own plane decides.
      std::size_t against = 0, inPlane = 0;
      for (const std::uint32_t j : list) {
        if (std::abs(glm::dot(place(j) - place(i), sheet.normals[i])) > kInPlane * glm::distance(place(j), place(i)))
          continue;
        ++inPlane;
        against += glm::dot(sheet.normals[i], sheet.normals[j]) < 0;
      }
      faults.turned += sheet.inRegion[i] && 4 * against > 3 * inPlane;
      continue;
    }
    if (list.size() < kMinNeighbours + 1) continue;
    for (const std::uint32_t j : list) mean += place(j) / static_cast<double>(list.size());
    SymmetricMatrix3 spread;
    for (const std::uint32_t j : list) spread.addSquare(place(j) - mean);
    fits[i] = eigenSymmetric(spread).vectors[0];
  }
  std::vector<char> known(count, 0);
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> edges;
  const auto reach = [&](std::uint32_t i) {
    known[i] = 1;
    for (const std::uint32_t j : neighbours[i]) {
      if (known[j] || fits[j] == DVec3(0)) continue;
      const DVec3 way = place(j) - place(i);
      const double length = glm::length(way);
      const double across =
          length > 0 ? std::max(std::abs(glm::dot(way, fits[i])), std::abs(glm::dot(way, fits[j]))) / length : 1;
      edges.push({1 - std::abs(glm::dot(fits[i], fits[j])) + across, i, j});
    }
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!sheet.rests[i] || fits[i] == DVec3(0)) continue;
    if (glm::dot(fits[i], sheet.normals[i]) < 0) fits[i] = -fits[i];
    known[i] = 1;
  }
  for (std::uint32_t i = 0; i < count; ++i)
    if (known[i]) reach(i);
  constexpr double kDearest = 0.8;  // beyond, a step leads to another sheet
  while (!edges.empty()) {
    const Edge edge = edges.top();
    edges.pop();
    if (known[edge.to] || edge.cost > kDearest) continue;
    if (glm::dot(fits[edge.to], fits[edge.from]) < 0) fits[edge.to] = -fits[edge.to];
    faults.turned += sheet.inRegion[edge.to] && glm::dot(fits[edge.to], sheet.normals[edge.to]) < 0;
    reach(edge.to);
  }
  return faults;
}

bool exceeds(std::size_t after, std::size_t before, std::size_t region) {
  const double more = static_cast<double>(after) - static_cast<double>(before);
  return more >= StrokeTolerance::kFewest && more > StrokeTolerance::kShare * static_cast<double>(region);
}

}  // namespace

std::span<const std::string_view> strokeCriteria() { return kCriteria; }

std::vector<std::string_view> StrokeVerdict::broken() const {
  const std::array<bool, kCriteria.size()> flags{raises, turns, crowds, tears, goesDeep, goesShallow, movesFar, folds};
  std::vector<std::string_view> names;
  for (std::size_t k = 0; k < flags.size(); ++k)
    if (flags[k]) names.push_back(kCriteria[k]);
  return names;
}

double StrokeVerdict::badness() const {
  if (broken().empty()) return 0;
  const double all = static_cast<double>(std::max<std::size_t>(region, 1));
  return static_cast<double>(broken().size()) + 4 * static_cast<double>(turned + shreds) / all +
         std::min(raised_mm, 20.0) / 5 +
         (needed > 0 ? std::min(static_cast<double>(region) / static_cast<double>(needed), 4.0) : 0);
}

StrokeVerdict StrokeJudge::judge(std::span<const PointState> after, const PlayedStroke& stroke) {
  StrokeVerdict verdict;
  const std::size_t old = before_.size();
  const double mm = stroke.mm_per_unit;
  const auto was = [&](std::uint32_t i) { return DVec3(before_.positions[i]); };
  const auto faced = [&](std::uint32_t i) { return DVec3(before_.normals[i]); };
  const auto ancestorOf = [&](std::uint32_t i) {
    while (i >= old && after[i].parent != i && after[i].parent < after.size()) i = after[i].parent;
    return std::min<std::uint32_t>(i, static_cast<std::uint32_t>(old) - 1);
  };
  std::vector<char> touched(after.size(), 0);
  std::vector<std::uint32_t> changed;
  for (std::uint32_t i = 0; i < after.size(); ++i) {
    const bool there = !after[i].gone();
    touched[i] = i < old ? !there || after[i].position != before_.positions[i] : there;
    if (!touched[i]) continue;
    changed.push_back(i);
    verdict.inserted += i >= old;
    verdict.removed += i < old && !there;
  }
  verdict.changed = changed.size();
  verdict.expected_mm = std::max(0.0, stroke.depth_mm - stroke.yield_mm);
  if (changed.empty()) {
    verdict.goesShallow = stroke.brush == BrushKind::push && !stroke.isOpen && verdict.expected_mm > 0;
    return verdict;
  }

  std::vector<double> spacings(old, 0);
  const auto spacing = [&](std::uint32_t i) {
    double& known = spacings[i];
    if (known == 0) known = heights_.spacingAt(was(i), faced(i));
    return known;
  };
  // The region: changed points, and those around them before and after. Around it, points at rest.
  std::vector<Vec3> places;
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < after.size(); ++i)
    if (!after[i].gone()) {
      places.push_back(after[i].position);
      numbers.push_back(i);
    }
  const PointTree treeAfter(places);
  std::vector<char> near(after.size(), 0);  // 2: in the region, 1: around it
  std::vector<std::uint32_t> found;
  for (const std::uint32_t i : changed) {
    const double h = spacing(ancestorOf(i));
    near[i] = 2;
    const auto mark = [&](std::uint32_t j, double distance) {
      near[j] = std::max<char>(near[j], distance < kNearby * h ? 2 : 1);
    };
    if (i < old) {
      found.clear();
      tree_.near(was(i), 2 * kNearby * h, found);
      for (const std::uint32_t j : found) mark(j, glm::distance(was(j), was(i)));
    }
    if (after[i].gone()) continue;
    const DVec3 place(after[i].position);
    found.clear();
    treeAfter.near(place, 2 * kNearby * h, found);
    for (const std::uint32_t j : found) mark(numbers[j], glm::distance(DVec3(places[j]), place));
  }
  const auto isThin = [&](std::uint32_t i) {
    const NearestPoints around = nearestTo(tree_, was(i));
    for (std::size_t k = 0; k < around.count; ++k) {
      if (around.squared[k] > kThin * kThin * spacing(i) * spacing(i)) break;
      if (glm::dot(faced(i), faced(around.points[k])) < kOtherSide) return true;
    }
    return false;
  };
  Sheet then, now;
  for (std::uint32_t i = 0; i < after.size(); ++i) {
    if (near[i] == 0) continue;
    const double h = spacing(ancestorOf(i));
    const auto add = [&](Sheet& sheet, const Vec3& place, const Vec3& normal) {
      sheet.places.push_back(place);
      sheet.normals.emplace_back(normal);
      sheet.spacings.push_back(h);
      sheet.inRegion.push_back(near[i] == 2);
      sheet.rests.push_back(!touched[i]);
      sheet.isThin.push_back(isThin(ancestorOf(i)));
    };
    if (i < old) add(then, before_.positions[i], before_.normals[i]);
    if (!after[i].gone()) add(now, after[i].position, after[i].normal);
  }
  const Faults faultsThen = faultsOf(then), faultsNow = faultsOf(now);
  verdict.region = faultsNow.region, verdict.regionBefore = faultsThen.region;
  verdict.turned = faultsNow.turned, verdict.turnedBefore = faultsThen.turned;
  verdict.shreds = faultsNow.shreds, verdict.shredsBefore = faultsThen.shreds;
  verdict.turns = exceeds(verdict.turned, verdict.turnedBefore, verdict.region);
  verdict.tears = exceeds(verdict.shreds, verdict.shredsBefore, verdict.region);

  // Points that the walls of the deepest allowed dent or bump may need beside those that were there.
  double h = 0;
  for (const double each : then.spacings) h += each / static_cast<double>(then.spacings.size());
  const double along = (2 * stroke.drag_mm + 2 * 3.1416 * stroke.radius_mm) / mm;
  const bool grabs = stroke.brush == BrushKind::grab;
  const double carried = grabs ? std::min(stroke.drag_mm, 2 * stroke.radius_mm) + stroke.lift_mm : 0;
  const double high = (stroke.depth_mm + carried) / mm;
  verdict.needed = verdict.regionBefore + static_cast<std::size_t>(along * high / (h * h));
  verdict.crowds = static_cast<double>(verdict.region) > StrokeTolerance::kCrowd * static_cast<double>(verdict.needed);

  const auto axisAt = [&](const DVec3& place) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < stroke.spots.size(); ++k)
      if (glm::distance(place, stroke.spots[k]) < glm::distance(place, stroke.spots[best])) best = k;
    return stroke.normals[best];
  };
  // Whether a point faced away from the tool wherever that came near it: a drag may lead around an edge.
  const auto facesAway = [&](const DVec3& place, const DVec3& normal) {
    const double reach = 2 * stroke.radius_mm / mm;
    double most = glm::dot(normal, axisAt(place));
    for (std::size_t k = 0; k < stroke.spots.size(); ++k)
      if (glm::distance(place, stroke.spots[k]) < reach) most = std::max(most, glm::dot(normal, stroke.normals[k]));
    return most < kAway;
  };
  const bool presses = stroke.brush == BrushKind::push || stroke.brush == BrushKind::carve;
  const double highest = presses ? StrokeTolerance::kRaised_mm : stroke.depth_mm + StrokeTolerance::kOverDepth_mm;
  for (const std::uint32_t i : changed) {
    if (after[i].gone()) continue;
    const DVec3 place(after[i].position);
    const std::uint32_t ancestor = ancestorOf(i);
    const double height = mm * heights_.heightAt(place);
    verdict.raised_mm = std::max(verdict.raised_mm, height);
    if (height > highest + carried) {
      ++verdict.raisedPoints;
      std::array<std::uint32_t, 1> nearest{};
      std::array<double, 1> squared{};
      tree_.nearest(Vec3(place), nearest, squared);
      verdict.through += glm::dot(faced(nearest[0]), faced(ancestor)) < kThrough;
    }
    if (stroke.brush == BrushKind::carve) verdict.deepest_mm = std::max(verdict.deepest_mm, -height);
    if (i >= old) continue;
    const DVec3 axis = axisAt(was(i)), motion = place - was(i);
    if (stroke.brush != BrushKind::carve) {
      // A bump of a rough surface moves further than it ends below that surface; a thin part has no depth of its own.
      const double inwards = -mm * glm::dot(motion, axis);
      verdict.deepest_mm = std::max(verdict.deepest_mm, stroke.isOpen ? inwards : std::min(inwards, -height));
    }
    if (stroke.brush != BrushKind::carve && !grabs && facesAway(was(i), faced(i)))
      verdict.farMoved_mm = std::max(verdict.farMoved_mm, mm * glm::length(motion));
    // Neighbours that have passed each other.
    const double reach = spacing(i);
    found.clear();
    tree_.near(was(i), kPair * reach, found);
    for (const std::uint32_t j : found) {
      if (j == i || after[j].gone() || glm::dot(faced(i), faced(j)) < 0.5 || (touched[j] && j < i)) continue;
      DVec3 offset = was(j) - was(i);
      offset -= glm::dot(offset, faced(i)) * faced(i);
      const double squared = glm::dot(offset, offset);
      if (squared < kMinPair * kMinPair * reach * reach) continue;
      ++verdict.pairs;
      verdict.folded += glm::dot(offset, DVec3(after[j].position) - place) < kFlip * squared;
    }
  }
  verdict.raises = verdict.raisedPoints > 0;
  // The surface of coarse points is known to a part of their spacing.
  const double slack = StrokeTolerance::kDepthSlack_mm + StrokeTolerance::kRough * h * mm;
  const double deepest = (presses ? verdict.expected_mm : stroke.depth_mm) * (1 + StrokeTolerance::kDeeper) + slack;
  verdict.goesDeep = verdict.deepest_mm > deepest + carried;
  verdict.goesShallow =
      stroke.brush == BrushKind::push && !stroke.isOpen &&
      verdict.deepest_mm + StrokeTolerance::kDepthSlack_mm < StrokeTolerance::kShallow * verdict.expected_mm;
  verdict.movesFar = verdict.farMoved_mm > StrokeTolerance::kFar_mm;
  verdict.folds = exceeds(verdict.folded, 0, verdict.pairs);
  return verdict;
}

}  // namespace palpate
