// Strokes on one of several limbs that are close to each other, on each back end: the others stay as they are, bit by
// bit.
#include <fmt/format.h>

#include "tests/near.hpp"
#include "tests/touch/limbs.hpp"

namespace palpate::limbs_test {

namespace {

// Two rods of 6 mm along y, the pressed one about (0, y, -6), on its flank towards the other.
const DVec3 kAlongY{0, 1, 0};
LimbPlace onRod(double x) { return {{x, 0.2, std::sqrt(36 - x * x) - 6}, DVec3(x, 0, std::sqrt(36 - x * x)) / 6.0}; }
Limbs twoRods(double gap, bool random) {
  Limbs limbs(random);
  limbs.addRod({12 + gap, 0, -6}, kAlongY, 6, 50);
  limbs.addRod({0, 0, -6}, kAlongY, 6, 50);
  return limbs;
}

/// A place with a part beside, above or below the touched one, which only carve may change.
struct Place {
  std::string name;
  Limbs limbs;        // the points of the other part come first
  std::size_t other;  // their number
  LimbPlace at;
  double depth;                       // of a press
  std::optional<std::size_t> inside;  // more of the other points than this a push without a limit would move
  double accuracy;                    // of the depth that is left; 0: the part below leaves more than 2
  bool isFlat = false;                // there is nothing to smooth
};

/// `gap`: to the other part, in radii of the brush.
Place besideRod(double gap, bool random) {
  Limbs limbs = twoRods(gap * kLimbBrush, random);
  const std::size_t other = limbs.size() / 2;
  return {.name = fmt::format("{} rods, {} apart", random ? "random" : "even", gap),
          .limbs = std::move(limbs),
          .other = other,
          .at = onRod(4),
          .depth = 4,
          .inside = gap < 0.9 ? std::optional<std::size_t>(5) : std::nullopt,
          .accuracy = random ? 0.15 : 0.05};
}
/// A rod of 3 mm crosses over the pressed one, and the ball comes down beside it.
Place underRod(double gap) {
  Limbs limbs(false);
  limbs.addRod({0, 0, gap * kLimbBrush + 3}, {1, 0, 0}, 3, 50);
  const std::size_t other = limbs.size();
  limbs.addRod({0, 0, -6}, kAlongY, 6, 50);
  return {fmt::format("a crossing rod, {} above", gap), limbs, other, {{0, 6, 0}, {0, 0, 1}}, 3, 20, 0.05};
}
Place overPlate(double gap) {
  Limbs limbs(false);
  limbs.addPlate({0, 0, -4 - gap * kLimbBrush}, 40, 4);
  const std::size_t other = limbs.size();
  limbs.addPlate({0, 0, 0}, 40, 4);
  const double depth = 4 + gap * kLimbBrush + 2;
  return {fmt::format("a plate, {} below", gap), limbs, other, {{0.3, 0.2, 0}, {0, 0, 1}}, depth, 20, 0, true};
}

/// One of each kind, for what holds with every brush: a new place is a row here. A software GPU only has time for one.
std::vector<Place> places() {
  if (kOnGpu) return {besideRod(0.3, true)};
  return {besideRod(0.3, true), underRod(0.3), overPlate(0.3)};
}

/// A press at the place; returns the cloud after it.
PointCloud checkPress(const OnBackEnd& backEnd, const Place& place) {
  CAPTURE(place.name);
  const PointCloud& before = place.limbs.cloud();
  if (place.inside) CHECK(insideBall(before, place.other, place.at, place.depth) > *place.inside);
  PointCloud after = stroked(backEnd, place.limbs, BrushKind::push, pressed({place.at}, place.depth));
  CHECK(changedOf(before, after, 0, place.other) == 0);
  if (place.accuracy > 0)
    CHECK(depthUnder(after, place.at) == near(place.depth - kLimbTau, place.accuracy));
  else
    CHECK(depthUnder(after, place.at) > 2);
  return after;
}

}  // namespace

TEST_CASE_FIXTURE(OnBackEndInCore,
                  "a press on a limb leaves the limb beside it unchanged, at any gap, and is as deep as alone") {
  for (const Place& place : {besideRod(0.3, false), besideRod(1, false), besideRod(0.6, true), besideRod(2, true)}) {
    CAPTURE(place.name);
    const PointCloud after = checkPress(*this, place);
    // No point is between the rods.
    double farthest = 0;
    for (std::size_t i = place.other; i < after.size(); ++i)
      farthest = std::max(farthest, std::hypot(double{after.positions[i].x}, double{after.positions[i].z} + 6));
    CHECK(farthest < 6 + 0.25 * kLimbSpacing);
  }
}

TEST_CASE_FIXTURE(OnBackEndInCore, "a press leaves a limb that crosses over the pressed one unchanged") {
  for (const double gap : {0.3, 0.7}) checkPress(*this, underRod(gap));
}

TEST_CASE_FIXTURE(OnBackEndInCore, "a press on a plate leaves a plate below it unchanged") {
  for (const double gap : {0.3, 0.6}) checkPress(*this, overPlate(gap));
}

TEST_CASE_FIXTURE(OnBackEndInCore, "every brush but carve leaves the limb beside the touched one unchanged") {
  for (const Place& place : places())
    for (const auto& [name, kind] : kBrushKinds) {
      if (kind == BrushKind::carve || kind == BrushKind::push) continue;
      CAPTURE(place.name);
      CAPTURE(name);
      const PointCloud& before = place.limbs.cloud();
      std::vector<DVec3> path = pressed({place.at}, 3);
      if (kind == BrushKind::grab) path.push_back(path.back() + DVec3(2, 0, 2));
      const PointCloud after = stroked(*this, place.limbs, kind, path);
      CHECK(changedOf(before, after, 0, place.other) == 0);
      const bool alters = kind != BrushKind::smooth || !place.isFlat;
      CHECK((changedOf(before, after, place.other, before.size()) > 20) == alters);
    }
}

// Both faces of an edge belong to it.
TEST_CASE_FIXTURE(OnBackEndInCore, "a press on an edge moves both of its faces") {
  Limbs limbs(false);
  limbs.addPlate({-15, 0, 0}, 30, 20);
  const LimbPlace place{{0, 0.2, 0}, glm::normalize(DVec3(1, 0, 1))};
  const PointCloud before = limbs.cloud(), after = stroked(*this, limbs, BrushKind::push, pressed({place}, 4));
  std::size_t upper = 0, side = 0;
  for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
    if (after.positions[i] == before.positions[i]) continue;
    upper += before.normals[i].z > 0.9f;
    side += before.normals[i].x > 0.9f;
  }
  CHECK(upper > 30);
  CHECK(side > 30);
  CHECK(depthUnder(after, place) == near(4 - kLimbTau, 0.1));
}

// A wall on a floor: a ball that is pressed into the wall and dragged along it is in the floor with its side. The floor
// yields downwards; along the tool's axis it would be dragged to the wall, and a hole would be left.
TEST_CASE_FIXTURE(OnBackEndInCore, "a push along a wall leaves no hole in the floor beside it") {
  constexpr double kHigh = 4, kDepth = 4;
  const LimbPlace from{{0, -8, kHigh}, {1, 0, 0}}, to{{0, 8, kHigh}, {1, 0, 0}};
  for (const bool random : {false, true}) {
    CAPTURE(random);
    Limbs limbs(random);
    limbs.addSheet({0, -25, 0}, {0, 50, 0}, {0, 0, 25});
    limbs.addSheet({0, -25, 0}, {25, 0, 0}, {0, 50, 0});
    const PointCloud before = limbs.cloud();
    CHECK(insideBall(before, before.size(), to, kDepth) > 100);
    const PointCloud after = stroked(*this, limbs, BrushKind::push, pressed({from, to}, kDepth));
    CHECK(depthUnder(after, to) == near(kDepth - kLimbTau, random ? 0.15 : 0.05));
    CHECK(deepestInBall(after, to, kDepth) < 0.15);
    double lowest = 0;
    for (const Vec3& position : after.positions) lowest = std::min(lowest, double{position.z});
    CHECK(lowest == near(kHigh - kLimbBrush, 0.1));
    const auto gaps = [](const PointCloud& cloud) {
      return SurfaceGapFinder(cloud, kLimbSupport, kLimbSpacing).find([](const DVec3& at) {
        return std::abs(at.y) < 18 && at.x < 15 && at.z < 15;
      });
    };
    CHECK(gaps(after).widest <= std::max(1.4, gaps(before).widest));
  }
}

// Two sheets, 4 mm apart, one of which is dragged towards the other: they stay two.
TEST_CASE_FIXTURE(OnBackEndInCore, "two sheets that a grab has brought together are not joined") {
  Limbs limbs(false);
  limbs.addSheet({3, -25, 0}, {25, 0, 0}, {0, 50, 0});
  const std::size_t dragged = limbs.size();
  limbs.addSheet({-26, -25, 0}, {25, 0, 0}, {0, 50, 0});
  const PointCloud after = stroked(*this, limbs, BrushKind::grab, {{5, 0.2, 1}, {5, 0.2, -1}, {-1.2, 0.2, -1}});
  double edge = 3;
  for (std::size_t i = 0; i < dragged; ++i) edge = std::min(edge, double{after.positions[i].x});
  CHECK(edge < 1);
  CHECK(edge > 0);
  for (const Vec3& position : after.positions) CHECK((position.x < -1 || position.x > edge - 0.25 * kLimbSpacing));
}

// The side of a plate, held 2 mm under its edge and dragged into it by far more than its upper face, which is in the
// brush with it, can be compressed: the edge goes with the side, and nothing is drawn through below the upper face.
TEST_CASE_FIXTURE(OnBackEndInCore, "an edge is dragged with the side that is held under it, without holes") {
  const DVec3 held(0, 0.2, -2), in(-1, 0, 0);
  for (const bool random : {false, true}) {
    CAPTURE(random);
    Limbs limbs(random);
    limbs.addPlate({-15, 0, 0}, 30, 20);
    const PointCloud before = limbs.cloud();
    const PointCloud after = stroked(*this, limbs, BrushKind::grab, {held - in, held + in, held + 10.0 * in});
    const auto between = [](double low, double value, double high) { return low < value && value < high; };
    double edge = -1e9, side = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
      const DVec3 place(after.positions[i]), normal(after.normals[i]);
      if (!between(-1, place.y - held.y, 1) || !between(-8, place.x, 1)) continue;
      if (normal.z > 0.7 && place.z > -0.3) edge = std::max(edge, place.x);
      if (normal.x > 0.7 && between(-2.5, place.z, -1)) side = std::min(side, place.x);
    }
    CHECK(side < -2);
    CHECK(edge < side + kLimbSpacing);
    const auto gaps = [](const PointCloud& cloud) {
      return SurfaceGapFinder(cloud, kLimbSupport, kLimbSpacing).find([](const DVec3& at) {
        return at.x > -12 && std::abs(at.y) < 10 && at.z > -12;
      });
    };
    CHECK(gaps(after).widest <= std::max(1.4, gaps(before).widest));
  }
}

// A crease between two rods that have grown together: a push into it presses both.
TEST_CASE_FIXTURE(OnBackEndInCore, "a press into the crease of two limbs that have grown together moves both") {
  Limbs limbs(false);
  const DVec3 left(-4.5, 0, -6), right(4.5, 0, -6);
  limbs.addRod(left, kAlongY, 6, 50);
  const std::size_t all = limbs.size();
  limbs.cut(0, all, right, kAlongY, 6);
  const std::size_t first = limbs.size();
  limbs.addRod(right, kAlongY, 6, 50);
  limbs.cut(first, limbs.size(), left, kAlongY, 6);
  const LimbPlace place{{0, 0.2, -6 + std::sqrt(36 - 4.5 * 4.5)}, {0, 0, 1}};
  const PointCloud after = stroked(*this, limbs, BrushKind::push, pressed({place}, 3));
  CHECK(changedOf(limbs.cloud(), after, 0, first) > 30);
  CHECK(changedOf(limbs.cloud(), after, first, limbs.size()) > 30);
}

// Points of a dent's walls that do not face its middle.
std::size_t turnedAwayFrom(const DVec3& ball, const PointCloud& cloud) {
  std::size_t turned = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const DVec3 offset = DVec3(cloud.positions[i]) - ball, fromAxis(offset.x, offset.y, std::min(0.0, offset.z));
    turned += glm::length(fromAxis) < 1.05 * kLimbBrush && glm::dot(fromAxis, DVec3(cloud.normals[i])) > 0;
  }
  return turned;
}

// The walls of a dent belong to the next stroke, which deepens and widens it.
TEST_CASE_FIXTURE(OnBackEndInCore, "repeated presses widen and deepen a dent: its walls belong to the stroke") {
  Limbs limbs(false);
  limbs.addSheet({-25, -25, 0}, {50, 0, 0}, {0, 50, 0});
  const auto touch = make(limbs.cloud(), {.radius = kLimbSupport, .brush = limbBrush(BrushKind::push)});
  double time_s = 0;
  const auto press = [&](const LimbPlace& place, double depth) {
    stroked(*touch, limbs.cloud(), {{0, 0, 20}, {0, 0, 21}}, time_s += 1);  // the stroke before is over
    return stroked(*touch, limbs.cloud(), pressed({place}, depth), time_s);
  };
  const LimbPlace middle{{-8.3, 0.2, 0}, {0, 0, 1}}, first{{8.3, 0.2, 0}, {0, 0, 1}}, beside{{11.3, 0.2, 0}, {0, 0, 1}};
  press(middle, 3);
  const PointCloud deeper = press(middle, 9);
  CHECK(depthUnder(deeper, middle) == near(8.5, 0.05));
  CHECK(deepestInBall(deeper, middle, 9) < 0.1);
  CHECK(turnedAwayFrom(ballAt(middle, 9), deeper) == 0);
  CHECK(depthUnder(press(first, 3), first) == near(2.5, 0.05));
  const PointCloud wider = press(beside, 3);
  CHECK(depthUnder(wider, first) == near(2.5, 0.1));
  CHECK(depthUnder(wider, beside) == near(2.5, 0.1));
}

// One press that is dragged from one rod to the other presses both.
TEST_CASE_FIXTURE(OnBackEndInCore, "a press that is dragged from one limb to the next moves both") {
  const double gap = 0.3 * kLimbBrush;
  const Limbs limbs = twoRods(gap, false);
  const LimbPlace from = onRod(-1), to{{12 + gap + 1, 0.2, from.position.z}, {0, 0, 1}};
  const PointCloud after = stroked(*this, limbs, BrushKind::push, pressed({from, to}, 3));
  CHECK(depthUnder(after, from) == near(3 - kLimbTau, 0.1));
  CHECK(depthUnder(after, to) == near(3 - kLimbTau, 0.1));
}

}  // namespace palpate::limbs_test
