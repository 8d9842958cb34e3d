// Sculpting on the CPU with only the bricks around a hand: the same as with the whole cloud.
#include "haptics/sharing/brick_sculptor.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include "engine/core/error.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/sharing/brick_hand.hpp"

namespace palpate::brick_sculptor_test {

TEST_CASE("in virtual time each brush edits the points around a hand as it edits a whole cloud, bit by bit" *
          kMoreInFull) {
  const Scene scene = makeScene("bumpy-sphere", 20'000, DVec3(3e5, -1e5, 2e4));
  const Bounds box = boundsOf(scene.cloud);
  for (const double widening : byTier<std::vector<double>>({1.6}, {1.0, 1.6}))
    for (const BrushKind kind : {BrushKind::push, BrushKind::carve, BrushKind::inflate, BrushKind::smooth,
                                 BrushKind::grab, BrushKind::flatten}) {
      CAPTURE(static_cast<int>(kind));
      CAPTURE(widening);
      const BrushOptions brush{.kind = kind, .yieldDepth = 0.2, .pushRate = 0.5, .radius = 6, .resample = false};
      CpuTouch whole(scene.cloud, {.radius = scene.radius, .widening = widening, .brush = brush, .threads = 1});
      BrickHand hand(scene, {.widening = widening, .brush = brush});
      hand.source.apply(hand.bricks.whole(box.min - 40.0, box.max + 40.0));
      std::size_t touching = 0, differing = 0, tick = 0;
      for (const DVec3& hip : wanderingPath(scene, 300, 2 * scene.radius, 7)) {
        const Pose pose{.time_s = static_cast<double>(++tick) * 1e-3, .hip = hip};
        const Contact own = hand.touch->query(pose, 0), truth = whole.query(pose, 0);
        differing += !isSameContact(own, truth);
        touching += truth.touching;
      }
      CHECK(touching > 30);
      CHECK(differing == 0);
      hand.touch->finish();
      whole.finish();
      CHECK(hand.touch->report().editTimes_us.size() > 20);
      PointCloud sculpted = scene.cloud;
      CHECK(whole.readBack(sculpted) > 30);
      // Every point, compared with the whole cloud.
      std::vector<PointState> made;
      hand.source.takeMade(made);
      std::vector<PointState> states = statesOf(scene.cloud);
      for (const PointState& state : made) states[state.number()] = state;
      const PointCloud here = editedCloud(scene.cloud, states);
      CHECK(here.positions == sculpted.positions);
      CHECK(here.normals == sculpted.normals);
    }
}

TEST_CASE("in real time an edit waits until the last one is felt, so that a brush goes no deeper than the hand" *
          kClock) {
  const Scene scene = makeScene("sphere", 20'000);
  const BrushOptions brush{.kind = BrushKind::push, .yieldDepth = 0.2, .pushRate = 1, .radius = 6, .resample = false};
  BrickHand hand(scene, {.timeout_s = 0.2, .brush = brush});
  CpuTouch whole(scene.cloud, {.radius = scene.radius, .brush = brush, .threads = 1});
  hand.source.apply(hand.bricks.whole(DVec3(-70), DVec3(70)));
  constexpr double kBudget_us = 1e6;
  double time_s = 0;
  for (int i = 0; i < 1500; ++i) {
    const Pose pose{.time_s = time_s += 1e-3, .hip = DVec3(0, 0, std::max(46.0, 51 - 0.005 * i))};
    hand.touch->query(pose, kBudget_us);
    hand.touch->prepare();
    whole.query(pose, 0);
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  // Edits that were postponed because other programs had the processor are made now.
  for (int i = 0; i < 1500; ++i) {
    hand.touch->query({.time_s = time_s += 1e-3, .hip = DVec3(0, 0, 46)}, kBudget_us);
    hand.touch->prepare();
  }
  hand.touch->finish();
  whole.finish();
  const std::size_t edits = hand.touch->report().editTimes_us.size();
  CHECK(edits > 20);
  CHECK(hand.touch->report().firstEdit_s.has_value());
  std::vector<PointState> made;
  hand.source.takeMade(made);
  CHECK(made.size() > 50);
  double deepest = 50;
  for (const PointState& state : made) {
    deepest = std::min(deepest, double{glm::length(state.position)});
    CHECK(glm::distance(DVec3(state.position), DVec3(0, 0, 46)) < 2 * brush.radius + 4);
  }
  PointCloud there = scene.cloud;
  whole.readBack(there);
  double deepestThere = 50;
  for (const Vec3& position : there.positions) deepestThere = std::min(deepestThere, double{glm::length(position)});
  CHECK(deepest == near(deepestThere, 0.005));
  CHECK(deepest < 46.2 + 0.1);
  // Without a frame that contains the last edit no other edit is made, however long the hand presses.
  for (int i = 0; i < 20; ++i) {
    hand.touch->query({.time_s = time_s += 1e-3, .hip = DVec3(0, 0, 44.5)}, kBudget_us);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  hand.touch->finish();
  CHECK(hand.touch->report().editTimes_us.size() <= edits + 2);  // plus one as the hand stops
}

TEST_CASE("a hand without a brush, not sculpting, or in unknown bricks leaves every point unchanged") {
  const Scene scene = makeScene("sphere", 20'000);
  const BrushOptions brush{.kind = BrushKind::push, .yieldDepth = 0.2, .pushRate = 1, .radius = 6, .resample = false};
  BrickHand hand(scene, {.timeout_s = 0.2, .brush = brush});
  const auto press = [&](bool sculpts) {
    for (int i = 0; i < 60; ++i)
      hand.touch->query({.time_s = 1e-3 * i, .hip = DVec3(0, 0, 51 - 0.05 * i), .sculpts = sculpts}, 1e6);
  };
  std::vector<PointState> made;
  press(true);  // no brick is known
  hand.source.apply(hand.bricks.whole(DVec3(-70), DVec3(70)));
  press(false);
  hand.touch->setBrush(std::nullopt);
  press(true);
  hand.touch->finish();
  hand.source.takeMade(made);
  CHECK(made.empty());
  hand.touch->setBrush(brush);
  for (int i = 0; i < 60; ++i) hand.touch->query({.time_s = 1 + 1e-3 * i, .hip = DVec3(0, 0, 51 - 0.05 * i)}, 0);
  hand.touch->finish();
  hand.source.takeMade(made);
  CHECK(made.size() > 30);
  const BrickHand fixed(scene, {.fixed = "it is to be felt alone"});
  CHECK_THROWS_WITH_AS(fixed.touch->setBrush(brush), "it is to be felt alone", UsageError);
}

}  // namespace palpate::brick_sculptor_test
