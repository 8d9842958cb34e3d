// The pose of the tool while a hand sculpts, and the division into strokes.
#include "engine/core/brush_stroke.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "shaders/shared/edit.h"
#include "tests/near.hpp"

namespace palpate::brush_stroke_test {

namespace {

constexpr double kSupport = 2, kTau = 0.5, kRadius = 6;
const DVec3 kUp(0, 0, 1);

BrushOptions brush(BrushKind kind) {
  return {.kind = kind, .yieldDepth = kTau, .pushRate = 0.1, .radius = kRadius, .strength = 0.5};
}

// A hand over a plane at z = 0.
class Hand {
 public:
  explicit Hand(BrushKind kind) : stroke(kSupport) { stroke.setBrush(brush(kind)); }

  // The proxy is `behind` the hand along x.
  void feel(const DVec3& hip, double behind = 0, Press press = Press::contact, double after_s = 1e-3) {
    time_s += after_s;
    const bool touching = hip.z < 0;
    const DVec3 spring = touching ? DVec3(-behind, 0, -hip.z) : DVec3(0);
    stroke.feel({.normal = kUp, .touching = touching}, hip, spring, press, time_s);
  }
  const BrushStroke::Tool& next() { return stroke.next(time_s); }

  BrushStroke stroke;
  double time_s = 0;
};

// The measure of a tool over that plane, tilted to `normal`.
SurfaceMeasure measured(const DVec3& normal, double height_radii, int weights = 1000) {
  SurfaceMeasure measure;
  measure.add({.weight = weights,
               .normal = IVec3(weights * 511.0 * normal),
               .height = static_cast<int>(weights * 255 * height_radii)});
  return measure;
}

}  // namespace

TEST_CASE("the ball of a brush follows the measured surface normal above the hand, however far the proxy trails") {
  for (const BrushKind kind : {BrushKind::push, BrushKind::carve}) {
    Hand hand(kind);
    hand.feel({0, 0, -2}, 3);
    const auto& tool = hand.next();
    CHECK(tool.acts == 1);
    CHECK(tool.outward == kUp);
    CHECK(glm::distance(tool.center, DVec3(0, 0, -2 + kTau + kRadius)) < 1e-12);
    CHECK(tool.shaft == 0);
    // The measure of an edit takes effect from the next edit on.
    const DVec3 tilted = glm::normalize(DVec3(0.2, 0, 1));
    hand.stroke.note(measured(tilted, 2 / kRadius));
    hand.feel({0, 0, -2}, 3);
    CHECK(glm::distance(hand.next().outward, tilted) < 5e-3);
  }
}

TEST_CASE("a tool deeper than its ball's diameter continues outwards as a shaft, past the original surface") {
  Hand hand(BrushKind::push);
  hand.feel({0, 0, -12});
  const auto& tool = hand.next();
  CHECK(tool.center.z == near(-12 + kTau + kRadius, 1e-12));
  CHECK(tool.center.z + tool.shaft > 0);
  CHECK(tool.center.z + tool.shaft < kRadius);
  CHECK(glm::distance(tool.middle, tool.center + tool.shaft * kUp) + kRadius <= tool.reach * (1 + 1e-12));
  CHECK(glm::distance(tool.middle, tool.center) + kRadius <= tool.reach * (1 + 1e-12));
  CHECK(tool.reach <= 2.5 * kRadius);
  Hand far(BrushKind::push);
  far.feel({0, 0, -500});
  CHECK(far.next().reach <= 2.5 * kRadius);
}

TEST_CASE("a brush does not act while the hand withdraws, and acts while it moves sideways") {
  Hand hand(BrushKind::push);
  hand.feel({0, 0, -2});
  hand.next();
  hand.feel({0.1, 0, -2});
  CHECK(hand.stroke.acts());
  hand.next();
  hand.feel({0.1, 0, -1.9});
  CHECK_FALSE(hand.stroke.acts());
  CHECK(hand.next().acts == 0);
  hand.feel({0.3, 0, -1.85});
  CHECK(hand.stroke.acts());
}

TEST_CASE("the tool follows the hand no faster than points yield, and completes the path after the hand has lifted") {
  Hand hand(BrushKind::push);
  for (int k = 0; k <= 10; ++k) {
    hand.feel({2.0 * k, 0, -3});
    hand.next();
  }
  const double atEnd = hand.stroke.tool().center.x;
  CHECK(atEnd < 10);
  hand.feel({20, 0, 5});  // lifted
  double last = atEnd, longest = 0;
  int edits = 0;
  while (hand.stroke.acts() && ++edits < 200) {
    const auto& tool = hand.next();
    longest = std::max(longest, tool.center.x - last);
    last = tool.center.x;
    CHECK(tool.center.y == 0);
    CHECK(tool.center.z == near(-3 + kTau + kRadius, 1e-9));
  }
  CHECK(last == near(20, 1e-9));
  CHECK(longest <= static_cast<double>(shared::kLongestMove) * kSupport * 2 * (1 + 1e-9));
  CHECK(longest > 0.2);
}

TEST_CASE("a hand lifted and put down elsewhere in one stroke does not cut through what lies between") {
  Hand hand(BrushKind::carve);
  hand.feel({0, 0, -2});
  hand.next();
  hand.feel({0, 0, 3});
  hand.feel({30, 0, -2});
  CHECK(hand.next().center.x == near(30, 1e-12));
  CHECK(hand.stroke.number() == 1);
  // The jump is not lost when more positions follow than are kept.
  Hand late(BrushKind::carve);
  late.feel({0, 0, -2});
  late.next();
  late.feel({0, 0, 3});
  for (int k = 0; k < 1500; ++k) late.feel({35 + 5 * std::cos(0.5 * k), 5 * std::sin(0.5 * k), -2});
  CHECK(late.next().center.x >= 30);
  // A pause of one tick, as from a trembling hand, is not a jump.
  hand.feel({30, 0, -1.9});
  hand.feel({30.5, 0, -2});
  CHECK(hand.next().center.x == near(30.5, 1e-12));
}

TEST_CASE("contact gaps of up to 0.3 s belong to one stroke; longer gaps and a released button end it") {
  Hand hand(BrushKind::push);
  const auto press = [&](double after_s) {
    hand.feel({0, 0, -2}, 0, Press::contact, after_s);
    hand.next();
    hand.feel({0, 0, 1});
  };
  press(1e-3);
  CHECK(hand.stroke.number() == 1);
  press(0.25);
  CHECK(hand.stroke.number() == 1);
  press(0.35);
  CHECK(hand.stroke.number() == 2);
  hand.feel({0, 0, -2}, 0);
  hand.next();
  hand.feel({0, 0, -2}, 0, Press::none);
  CHECK_FALSE(hand.stroke.isGoingOn());
  press(1e-3);
  CHECK(hand.stroke.number() == 3);
  // Put down elsewhere, the stroke continues: the button is still held.
  hand.stroke.lift();
  press(1e-3);
  CHECK(hand.stroke.number() == 3);
}

TEST_CASE("one press of a button is one stroke, however long the hand touches nothing") {
  Hand hand(BrushKind::push);
  for (const double after_s : {1e-3, 0.25, 2.0}) {
    hand.feel({0, 0, -2}, 0, Press::button, after_s);
    hand.next();
    hand.feel({0, 0, 1}, 0, Press::button);
    CHECK(hand.stroke.number() == 1);
  }
  CHECK(hand.stroke.isGoingOn());
  hand.feel({0, 0, 1}, 0, Press::none);
  while (hand.stroke.hasWay()) hand.next();
  CHECK_FALSE(hand.stroke.isGoingOn());
  hand.feel({0, 0, -2}, 0, Press::button);
  CHECK(hand.stroke.number() == 2);
}

TEST_CASE("points are inserted while a stroke goes on and for a while after it, not for ever") {
  Hand hand(BrushKind::push);
  const auto fills = [&] { return hand.next().closes == 0; };
  hand.feel({0, 0, -2});
  CHECK(fills());
  hand.feel({0, 0, -2}, 0, Press::none);
  while (hand.stroke.hasWay()) CHECK(fills());
  int edits = 0;
  while (fills() && edits < 10'000) ++edits;
  CHECK(edits > 100);
  CHECK(edits < 1000);
  hand.feel({0, 0, -2});
  CHECK(fills());
}

TEST_CASE("a late edit has the effect of all ticks since the last one") {
  Hand hand(BrushKind::push);
  hand.feel({0, 0, -2});
  CHECK(hand.next().share == near(0.1, 1e-12));
  hand.feel({0, 0, -2}, 0, Press::contact, 3e-3);
  CHECK(hand.next().share == near(1 - 0.9 * 0.9 * 0.9, 1e-12));
  Hand inflate(BrushKind::inflate);
  inflate.feel({0, 0, -2});
  CHECK(inflate.next().share == near(0.5, 1e-12));
  CHECK(inflate.stroke.tool().height == near(2 - kTau, 1e-12));
  inflate.feel({0, 0, -2}, 0, Press::contact, 4e-3);
  CHECK(inflate.next().share == near(2, 1e-12));
}

TEST_CASE("grab keeps its points as the hand pulls, at most two radii outwards and half a radius sideways") {
  Hand hand(BrushKind::grab);
  hand.feel({0, 0, -1});
  hand.next();
  for (int k = 0; k < 40; ++k) hand.feel({k * 1.0, 0, k * 0.5});
  CHECK(hand.stroke.acts());
  const auto& tool = hand.next();
  CHECK(tool.center == DVec3(0));
  CHECK(tool.motion.z > 1.8 * kRadius);
  CHECK(tool.motion.x == near(0.5 * kRadius, 1e-9));
  CHECK(tool.reach <= 2.5 * kRadius);
  hand.feel({0, 0, 20}, 0, Press::none);
  CHECK_FALSE(hand.stroke.acts());
}

TEST_CASE("grab moves its points only as far as the connected surface ahead of them can follow") {
  // The motion of a hand on a plane, which an edge 2 mm beside it ends or not.
  const auto heldBy = [](const DVec3& way, bool hasEdge) {
    Hand hand(BrushKind::grab);
    hand.feel({0, 0, -1});
    const auto& tool = hand.next();
    const auto options = brushOf(brush(BrushKind::grab), kSupport);
    SurfaceMeasure measure;
    const auto enter = [&](const DVec3& place, const DVec3& normal) {
      measure.enter(shared::entered<double>(options, tool, place, {place, normal, double{shared::kUnseen}}));
    };
    for (double x = hasEdge ? -2 : -8; x <= 8; x += 0.5)
      for (double y = -8; y <= 8; y += 0.5) enter({x, y, 0}, kUp);
    for (double z = -0.5; hasEdge && z >= -8; z -= 0.5)
      for (double y = -8; y <= 8; y += 0.5) enter({-2, y, z}, {-1, 0, 0});
    hand.stroke.note(measure);
    for (int k = 1; k <= 40; ++k) hand.feel(DVec3(0, 0, -1) + k / 40.0 * way);
    return hand.next().motion;
  };
  CHECK(heldBy({0, 0, -30}, false).z == near(-1.9 * kRadius, 1e-9));
  CHECK(heldBy({20, 0, -30}, false).z < -1.6 * kRadius);
  CHECK(heldBy({0, 0, 30}, true).z == near(1.9 * kRadius, 1e-9));
  CHECK(heldBy({30, 0, 0}, true).x == near(0.5 * kRadius, 1e-9));
  // The side is moved along itself, and has 5.7 mm to its rim.
  CHECK(heldBy({0, 0, -30}, true).z == near(-kRadius * kRadius / (2 * 5.7), 0.1));
  CHECK(heldBy({0, 0, -2}, true).z == near(-2, 1e-9));
}

TEST_CASE("no tool reaches beyond the range of an edit, wherever the hand and the surface are") {
  for (const auto& [name, kind] : kBrushKinds) {
    CAPTURE(name);
    Hand hand(kind);
    for (int k = 1; k < 60; ++k) {
      const double depth = std::pow(1.3, k % 30) * 0.6, turn = 0.7 * k;
      hand.feel({100 * std::sin(turn), 100 * std::cos(2 * turn), -depth}, 5 * depth);
      const auto& tool = hand.next();
      CHECK(tool.reach <= 2.5 * kRadius);
      CHECK(std::isfinite(tool.center.x + tool.middle.y + tool.shaft + tool.hearing + tool.height));
      hand.stroke.note(measured(glm::normalize(DVec3(std::sin(3 * turn), std::cos(turn), 1)), 4 * std::sin(5.0 * k)));
    }
  }
}

TEST_CASE(
    "a hand that has gone through a thin part does nothing until it is at its side again, elsewhere or released") {
  // A leaf of 1 at z = 0; the hand is at its upper side, through its rim or through itself at the lower one.
  // Whether the stroke acts on it, after all that came before.
  double time_s = 0;
  const auto feel = [&](BrushStroke& stroke, const DVec3& hip, const DVec3& normal, double deep,
                        Press press = Press::contact) {
    while (stroke.hasWay()) stroke.next(time_s += 1e-3);
    time_s += 1e-3;
    stroke.feel({.normal = normal, .touching = deep > 0}, hip, deep * normal, press, time_s);
    return stroke.hasWay();
  };
  for (const bool endsContact : {false, true}) {
    CAPTURE(endsContact);
    BrushStroke stroke(kSupport);
    stroke.setBrush(brush(BrushKind::push));
    CHECK(feel(stroke, {0, 0, -1}, kUp, 1));
    CHECK(feel(stroke, {0.1, 0, -1}, kUp, 1));
    if (endsContact)  // deep, and for longer than a gap of a stroke
      for (int k = 0; k < 400; ++k) CHECK_FALSE(feel(stroke, {0.2, 0, -3}, kUp, 0));
    CHECK_FALSE(feel(stroke, {0.2, 0, -1.1}, -kUp, 1));
    CHECK_FALSE(feel(stroke, {0.3, 0, -1.1}, -kUp, 1));
    CHECK_FALSE(feel(stroke, {1.5 * kRadius, 0, -1.1}, -kUp, 1));
    BrushStroke back = stroke, elsewhere = stroke;
    CHECK(feel(back, {0.4, 0, -1}, kUp, 1));
    CHECK(feel(elsewhere, {2.5 * kRadius, 0, -1.1}, -kUp, 1));
    CHECK_FALSE(feel(stroke, {0.3, 0, -1.1}, -kUp, 1, Press::none));
    CHECK(feel(stroke, {0.3, 0, -1.1}, -kUp, 1));
  }
  // Carve may go on at the wall of a hole that it has cut.
  BrushStroke carves(kSupport);
  carves.setBrush(brush(BrushKind::carve));
  CHECK(feel(carves, {0, 0, -1}, kUp, 1));
  CHECK_FALSE(feel(carves, {0, 0, -3}, kUp, 0));
  CHECK(feel(carves, {2, 0, -3}, DVec3(-1, 0, 0), 1));
  // A hand that is pulled out at once has not gone through: it may press the wall beside.
  BrushStroke lifts(kSupport);
  lifts.setBrush(brush(BrushKind::push));
  CHECK(feel(lifts, {0, 0, -1}, kUp, 1));
  CHECK_FALSE(feel(lifts, {0, 0, 1}, kUp, 0));
  CHECK(feel(lifts, {2, 0, 0.5}, DVec3(-1, 0, 0), 1));
  // Around a limb that the brush can tell from a rim the side goes along with the hand.
  BrushStroke around(kSupport);
  around.setBrush(brush(BrushKind::push));
  for (double angle = 0; angle < 4; angle += 0.01) {
    const DVec3 normal(std::sin(angle), 0, std::cos(angle));
    CHECK(feel(around, 0.8 * kRadius * normal, normal, 1));
  }
}

TEST_CASE("overflowed or empty measures do not rotate the tool") {
  Hand hand(BrushKind::push);
  hand.feel({0, 0, -2});
  hand.next();
  hand.stroke.note({});
  hand.stroke.note(measured({0.1, 0, 0.1}, 0));
  hand.stroke.note(measured({3, 0, 3}, 0));
  hand.stroke.note(measured({1, 0, 0}, 40));
  hand.feel({0, 0, -2});
  CHECK(hand.next().outward == kUp);
  // Sums that overflow give the same differences.
  SurfaceMeasure before{.weights = 0xffffff00u, .normals = {5, 0x7fffffffu, 0xfffffff0u}, .heights = 0xfffffffeu};
  const SurfaceMeasure one = measured(kUp, -0.5);
  SurfaceMeasure after = before;
  after.add({.weight = 1000, .normal = IVec3(0, 0, 511'000), .height = -127'500});
  const SurfaceMeasure gap = after - before;
  CHECK(gap.weights == one.weights);
  CHECK(gap.normals == one.normals);
  CHECK(gap.heights == one.heights);
}

}  // namespace palpate::brush_stroke_test
