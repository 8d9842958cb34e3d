#include "engine/study/stroke_judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpate {

namespace {

constexpr std::array<std::string_view, 8> kCriteria{"raised", "turned",  "points",   "shreds",
                                                    "deep",   "shallow", "far side", "fold"};
constexpr double kNearby = 2.5;  // local spacings: neighbours of a point
constexpr std::size_t kMinNeighbours = 3, kOfAFlake = 6, kNearestOld = 3;
constexpr double kFlake = 1;  // local spacings off the plane of the neighbours
constexpr double kSame = 0.3, kAway = -0.8, kThrough = -0.3, kAgainst = -0.2;
constexpr double kOnSurface = 1.5;  // local spacings from a point
constexpr double kOutwards = 0.2;   // cosine
constexpr double kPair = 1.6, kMinPair = 0.5, kFlip = -0.1;

// A cloud at one moment: the points of the region and enough around them.
struct Sheet {
  std::vector<Vec3> places;
  std::vector<DVec3> normals;
  std::vector<double> spacings;
  std::vector<char> inRegion;
};

struct Shreds {
  std::size_t region = 0, shreds = 0;
};

Shreds shredsOf(const Sheet& sheet) {
  const PointTree tree(sheet.places);
  Shreds found;
  for (std::uint32_t i = 0; i < sheet.places.size(); ++i) {
    if (!sheet.inRegion[i]) continue;
    const DVec3 place(sheet.places[i]);
    const NearestPoints near = nearestTo(tree, place);
    const double h = sheet.spacings[i];
    std::size_t close = 0, flakes = 0, kin = 0;
    for (std::size_t k = 0; k < near.count; ++k) {
      const std::uint32_t j = near.points[k];
      const double distance = std::sqrt(near.squared[k]);
      if (j == i) continue;
      if (distance > 4 * h) break;
      close += distance <= kNearby * h;
      if (kin < kOfAFlake && glm::dot(sheet.normals[i], sheet.normals[j]) > kSame) {
        ++kin;
        flakes += std::abs(glm::dot(DVec3(sheet.places[j]) - place, sheet.normals[i])) > kFlake * h;
      }
    }
    ++found.region;
    found.shreds += close < kMinNeighbours || 2 * flakes > kOfAFlake || kin < kMinNeighbours;
  }
  return found;
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

std::uint32_t StrokeJudge::ancestorOf(std::span<const PointState> after, std::uint32_t i) const {
  while (i >= before_.size() && after[i].parent != i && after[i].parent < after.size()) i = after[i].parent;
  return std::min(i, static_cast<std::uint32_t>(before_.size()) - 1);
}

// Whether a straight way leads out of the surface before. Deep inside of a solid the nearest points, far away, do not
// show on which side of the surface a point is.
bool StrokeJudge::leadsOut(const DVec3& from, const DVec3& to) {
  const double length = glm::distance(from, to);
  if (length == 0) return false;
  const DVec3 direction = (to - from) / length;
  for (double gone = 0; gone < length;) {
    const DVec3 place = from + gone * direction;
    std::array<std::uint32_t, 1> nearest{};
    std::array<double, 1> squared{};
    tree().nearest(Vec3(place), nearest, squared);
    const DVec3 normal(before_.normals[nearest[0]]), offset = place - DVec3(before_.positions[nearest[0]]);
    const double h = surface_.spacingAt(DVec3(before_.positions[nearest[0]]), normal);
    if (squared[0] < kOnSurface * kOnSurface * h * h && glm::dot(direction, normal) > kOutwards &&
        glm::dot(offset + h * direction, normal) > 0)
      return true;
    gone += std::max(0.5 * h, std::sqrt(squared[0]) - kOnSurface * h);
  }
  return false;
}

// The surface that carve leaves faces the tool, a ball with a shaft of any length. Along the walls of a deep cut the
// motion of the points shows nothing: what faces the tool has not turned.
DVec3 towardsTool(const PlayedStroke& stroke, const DVec3& place) {
  const double radius = stroke.radius_mm / stroke.mm_per_unit;
  const double deep = (stroke.depth_mm - stroke.yield_mm) / stroke.mm_per_unit;
  DVec3 nearest(0);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < stroke.spots.size(); ++k) {
    const DVec3 offset = stroke.spots[k] + (radius - deep) * stroke.normals[k] - place;
    const DVec3 way = offset + std::max(0.0, -glm::dot(offset, stroke.normals[k])) * stroke.normals[k];
    if (glm::length(way) < least) least = glm::length(way), nearest = way;
  }
  return nearest;
}

// A point of the cloud has turned if it faces against the side to which the motion of its neighbours has carried its
// normal, not if the two are nearly at a right angle, as at the rim of a dent: its neighbours are those that it had
// before, and where some of them have moved the side is known no better. A new point has turned if both most of the
// nearest old ones of its side and the one from which it stems are against it: where the surface is stretched or bent
// over a rim, the nearest ones alone may be beyond the rim. The wall that carve leaves faces the tool.
std::size_t StrokeJudge::turnedIn(std::span<const PointState> after, std::span<const char> near,
                                  const PlayedStroke& stroke) const {
  const std::size_t old = before_.size();
  const auto facesTool = [&](const PointState& point) {
    return stroke.removes() && glm::dot(towardsTool(stroke, DVec3(point.position)), DVec3(point.normal)) >= 0;
  };
  std::vector<std::optional<DVec3>> carried(old);
  std::vector<Vec3> places;
  std::vector<std::uint32_t> numbers;
  std::size_t turned = 0;
  for (std::uint32_t i = 0; i < old; ++i) {
    if (near[i] == 0 || after[i].gone || !tellsItsSide(before_, tree(), i)) continue;
    carried[i] = carriedNormal(before_, tree(), after, i);
    if (!carried[i]) continue;
    turned += near[i] == 2 && glm::dot(*carried[i], DVec3(after[i].normal)) < kAgainst && !facesTool(after[i]);
    places.push_back(after[i].position);
    numbers.push_back(i);
  }
  if (places.empty()) return turned;
  const PointTree tree(places);
  for (std::size_t i = old; i < after.size(); ++i) {
    if (near[i] != 2 || after[i].gone) continue;
    const DVec3 place(after[i].position), normal(after[i].normal);
    const std::uint32_t ancestor = ancestorOf(after, static_cast<std::uint32_t>(i));
    const NearestPoints nearest = nearestTo(tree, place);
    std::size_t count = 0, against = 0;
    for (std::size_t k = 0; k < nearest.count && count < kNearestOld; ++k) {
      const std::uint32_t other = numbers[nearest.points[k]];
      if (glm::dot(DVec3(before_.normals[other]), DVec3(before_.normals[ancestor])) < kSame) continue;
      ++count;
      against += glm::dot(*carried[other], normal) < kAgainst;
    }
    const std::optional<DVec3> origin = ancestor < old ? carried[ancestor] : std::nullopt;
    turned += 2 * against > count && !(origin && glm::dot(*origin, normal) >= kAgainst) && !facesTool(after[i]);
  }
  return turned;
}

StrokeVerdict StrokeJudge::judge(std::span<const PointState> after, const PlayedStroke& stroke) {
  StrokeVerdict verdict;
  const std::size_t old = before_.size();
  const double mm = stroke.mm_per_unit;
  const auto was = [&](std::uint32_t i) { return DVec3(before_.positions[i]); };
  const auto faced = [&](std::uint32_t i) { return DVec3(before_.normals[i]); };
  const auto ancestorOf = [&](std::uint32_t i) { return this->ancestorOf(after, i); };
  std::vector<char> touched(after.size(), 0);
  std::vector<std::uint32_t> changed;
  for (std::uint32_t i = 0; i < after.size(); ++i) {
    const bool there = !after[i].gone;
    touched[i] = i < old ? !there || after[i].position != before_.positions[i] : there;
    if (!touched[i]) continue;
    changed.push_back(i);
    verdict.inserted += i >= old;
    verdict.removed += i < old && !there;
  }
  verdict.changed = changed.size();
  verdict.expected_mm = std::max(0.0, stroke.depth_mm - stroke.yield_mm);
  if (changed.empty()) {
    verdict.goesShallow = stroke.presses() && !stroke.removes() && !stroke.isOpen && verdict.expected_mm > 0;
    return verdict;
  }

  std::vector<double> spacings(old, 0);
  const auto spacing = [&](std::uint32_t i) {
    double& known = spacings[i];
    if (known == 0) known = surface_.spacingAt(was(i), faced(i));
    return known;
  };
  // The region: changed points, and those around them before and after. Around it, points at rest.
  std::vector<Vec3> places;
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < after.size(); ++i)
    if (!after[i].gone) {
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
      tree().near(was(i), 2 * kNearby * h, found);
      for (const std::uint32_t j : found) mark(j, glm::distance(was(j), was(i)));
    }
    if (after[i].gone) continue;
    const DVec3 place(after[i].position);
    found.clear();
    treeAfter.near(place, 2 * kNearby * h, found);
    for (const std::uint32_t j : found) mark(numbers[j], glm::distance(DVec3(places[j]), place));
  }
  Sheet then, now;
  for (std::uint32_t i = 0; i < after.size(); ++i) {
    if (near[i] == 0) continue;
    const double h = spacing(ancestorOf(i));
    const auto add = [&](Sheet& sheet, const Vec3& place, const Vec3& normal) {
      sheet.places.push_back(place);
      sheet.normals.emplace_back(normal);
      sheet.spacings.push_back(h);
      sheet.inRegion.push_back(near[i] == 2);
    };
    if (i < old) add(then, before_.positions[i], before_.normals[i]);
    if (!after[i].gone) add(now, after[i].position, after[i].normal);
  }
  const Shreds shredsThen = shredsOf(then), shredsNow = shredsOf(now);
  verdict.region = shredsNow.region, verdict.regionBefore = shredsThen.region;
  verdict.shreds = shredsNow.shreds, verdict.shredsBefore = shredsThen.shreds;
  verdict.turned = turnedIn(after, near, stroke);
  verdict.turns = exceeds(verdict.turned, 0, verdict.region);
  verdict.tears = exceeds(verdict.shreds, verdict.shredsBefore, verdict.region);

  // Points that the walls of the deepest allowed dent or bump may need beside those that were there.
  double h = 0;
  for (const double each : then.spacings) h += each / static_cast<double>(then.spacings.size());
  const double along = (2 * stroke.drag_mm + 2 * 3.1416 * stroke.radius_mm) / mm;
  const bool grabs = brushHas(stroke.brush, shared::kHoldsPoints);
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
  const bool presses = stroke.presses();
  const double highest = presses ? StrokeTolerance::kRaised_mm : stroke.depth_mm + StrokeTolerance::kOverDepth_mm;
  for (const std::uint32_t i : changed) {
    if (after[i].gone) continue;
    const DVec3 place(after[i].position);
    const std::uint32_t ancestor = ancestorOf(i);
    const double height = mm * surface_.heightAt(place);
    const bool isOver = height > highest + carried;
    const bool isOut = isOver && (!presses || leadsOut(was(ancestor), place));
    if (!isOver || isOut) verdict.raised_mm = std::max(verdict.raised_mm, height);
    if (isOut) {
      ++verdict.raisedPoints;
      std::array<std::uint32_t, 1> nearest{};
      std::array<double, 1> squared{};
      tree().nearest(Vec3(place), nearest, squared);
      verdict.through += glm::dot(faced(nearest[0]), faced(ancestor)) < kThrough;
    }
    if (stroke.removes()) verdict.deepest_mm = std::max(verdict.deepest_mm, -height);
    if (i >= old) continue;
    const DVec3 axis = axisAt(was(i)), motion = place - was(i);
    if (!stroke.removes()) {
      // A bump of a rough surface moves further than it ends below that surface; a thin part has no depth of its own.
      const double inwards = -mm * glm::dot(motion, axis);
      verdict.deepest_mm = std::max(verdict.deepest_mm, stroke.isOpen ? inwards : std::min(inwards, -height));
    }
    if (!stroke.removes() && !grabs && facesAway(was(i), faced(i)))
      verdict.farMoved_mm = std::max(verdict.farMoved_mm, mm * glm::length(motion));
    // Neighbours that have passed each other.
    const double reach = spacing(i);
    found.clear();
    tree().near(was(i), kPair * reach, found);
    for (const std::uint32_t j : found) {
      if (j == i || after[j].gone || glm::dot(faced(i), faced(j)) < 0.5 || (touched[j] && j < i)) continue;
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
      stroke.presses() && !stroke.removes() && !stroke.isOpen &&
      verdict.deepest_mm + StrokeTolerance::kDepthSlack_mm < StrokeTolerance::kShallow * verdict.expected_mm;
  verdict.movesFar = verdict.farMoved_mm > StrokeTolerance::kFar_mm;
  verdict.folds = exceeds(verdict.folded, 0, verdict.pairs);
  return verdict;
}

}  // namespace palpate
