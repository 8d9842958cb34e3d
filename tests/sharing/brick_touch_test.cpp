// A cloud on the CPU with only the bricks around a hand: felt and sculpted bit by bit as the whole one, or not at all.
#include "haptics/sharing/brick_touch.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <set>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/sharing/brick_hand.hpp"

namespace palpate::brick_touch_test {

TEST_CASE("in virtual time a hand that waits for its bricks feels the whole cloud, bit by bit, also far from zero") {
  for (const DVec3 center : {DVec3(0), DVec3(1e6, -2e6, 3e6)})
    for (const double edge_radii : {0.8, 3.0}) {
      const Scene scene = makeScene("bumpy-sphere", 30'000, center);
      CpuTouch whole(scene.cloud, {.radius = scene.radius, .threads = 1});
      BrickHand hand(scene, {.edge_radii = edge_radii});
      // They are received from another thread, only the requested ones, and far ones are dropped.
      std::atomic<bool> stop = false;
      std::jthread server([&] {
        std::set<BrickKey> given;
        while (!stop) {
          std::this_thread::sleep_for(std::chrono::microseconds(200));
          const auto asked = hand.source.asked();
          if (!asked) continue;
          const HandReach& reach = asked->hands[0];
          BrickUpdate update = hand.bricks.around(reach.low, reach.high);
          std::erase_if(update.bricks, [&](const auto& brick) { return given.contains(brick.first); });
          const BrickBox box = hand.source.grid().boxOf(reach.low - 2 * scene.radius, reach.high + 2 * scene.radius);
          std::set<BrickKey> near;
          box.forEach([&](const IVec3& brick) { near.insert(BrickGrid::keyOf(brick)); });
          for (const BrickKey key : given)
            if (!near.contains(key)) update.dropped.push_back(key);
          for (const BrickKey key : update.dropped) given.erase(key);
          for (const auto& [key, brick] : update.bricks) given.insert(key);
          if (!update.bricks.empty() || !update.dropped.empty()) hand.source.apply(std::move(update));
        }
      });
      std::size_t touching = 0, differing = 0, tick = 0;
      for (const DVec3& hip : wanderingPath(scene, 1500, 2 * scene.radius, 4)) {
        const Pose pose{.time_s = static_cast<double>(tick++) * 1e-3, .hip = hip};
        const Contact own = hand.touch->query(pose, 0), truth = whole.query(pose, 0);
        differing += !isSameContact(own, truth);
        touching += truth.touching;
      }
      stop = true;
      CAPTURE(edge_radii);
      CHECK(differing == 0);
      CHECK(touching > 200);
      CHECK(hand.touch->counts().ticks == 1500);
      CHECK(hand.touch->counts().without == 0);
      CHECK(hand.source.known().points < scene.cloud.size() / 2);
    }
}

TEST_CASE("in real time a hand feels nothing and counts it where bricks are missing, never a surface with a hole") {
  const Scene scene = makeScene("sphere", 30'000);
  CpuTouch whole(scene.cloud, {.radius = scene.radius, .threads = 1});
  BrickHand hand(scene, {});
  // Half of space is unknown.
  hand.source.apply(hand.bricks.around(DVec3(-70), DVec3(70), [](const IVec3& brick) { return brick.x >= 0; }));
  constexpr double kBudget_us = 1e6;
  const auto ask = [&](double time_s, const DVec3& hip) {
    const Pose pose{.time_s = time_s, .hip = hip};
    const Contact own = hand.touch->query(pose, kBudget_us), truth = whole.query(pose, kBudget_us);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return std::pair(own, truth);
  };
  // Along the sphere's top, half a unit deep, from the known half into the unknown one and back.
  std::size_t without = 0, felt = 0, wrong = 0, free = 0;
  double time_s = 0;
  const auto knowsPointsAt = [&](const DVec3& hip) {
    for (const Stopwatch watch; watch.elapsed_s() < 30;) {
      const std::uint64_t before = hand.touch->counts().without;
      ask(time_s += 1e-3, hip);
      if (hand.touch->counts().without == before) return true;
    }
    return false;
  };
  REQUIRE(knowsPointsAt(DVec3(20, 0, 60)));
  for (int i = 0; i < 1200; ++i) {
    const double angle = 0.4 * std::cos(i * 0.005), depth = std::min(0.5, -1 + i * 0.01);
    const auto [own, truth] = ask(time_s += 1e-3, (50 - depth) * DVec3(std::sin(angle), 0, std::cos(angle)));
    CHECK(own.valid);
    const bool isKnown = 50 * std::sin(angle) > 8 * scene.radius;
    if (own.touching) {
      ++felt;
      wrong += glm::distance(own.proxy, truth.proxy) > 1e-9;
    } else if (truth.touching) {
      ++(isKnown ? free : without);
      if (!isKnown) CHECK(own.proxy != truth.proxy);
    }
  }
  CHECK(felt > 100);
  CHECK(wrong == 0);
  CHECK(without > 300);
  CHECK(hand.touch->counts().without > 300);
  // All is known: the whole surface is felt again.
  hand.source.apply(hand.bricks.around(DVec3(-70), DVec3(70)));
  REQUIRE(knowsPointsAt(DVec3(-20, 0, 60)));
  const std::uint64_t before = hand.touch->counts().without;
  for (int i = 0; i < 60; ++i) {
    const auto [own, truth] = ask(time_s += 1e-3, DVec3(-20, 0, 47 - 0.04 * i));
    CHECK(own.touching == truth.touching);
    if (truth.touching) CHECK(own.proxy == truth.proxy);
  }
  CHECK(hand.touch->counts().without == before);
}

TEST_CASE("a timeout while waiting for bricks in virtual time ends the session without force, with a reason") {
  const Scene scene = makeScene("sphere", 2000);
  BrickHand hand(scene, {.timeout_s = 0.2});
  const Contact contact = hand.touch->query({.time_s = 0, .hip = DVec3(0, 0, 49)}, 0);
  CHECK_FALSE(contact.valid);
  CHECK(contact.lost);
  CHECK_FALSE(contact.touching);
  CHECK_THROWS_WITH(hand.touch->finish(), doctest::Contains("were not received within"));
}

TEST_CASE("bricks that were waited for are in the frame of their time even if dropped since, but not in later frames") {
  BrickSource source({.edge = 1, .points = 10});
  auto brick = std::make_shared<Brick>();
  brick->ids = {4};
  brick->positions = {Vec3(0.5f)};
  brick->normals = {Vec3(0, 0, 1)};
  const BrickKey key = BrickGrid::keyOf(IVec3(0));
  BrickUpdate comes, goes;
  comes.bricks.emplace_back(key, blockOf(brick));
  goes.dropped = {key};
  HandReaches hands{.time_s = 0.25, .count = 1};
  hands.hands[0] = {.low = DVec3(0.4), .high = DVec3(0.6)};
  source.apply(comes);
  REQUIRE(source.await(hands, 0));
  source.apply(goes);
  CloudFrame frame;
  REQUIRE(source.hasNewer(0.25, -1));
  source.makeFrame(0.25, frame);
  CHECK(frame.size() == 1);
  CHECK(source.covers(frame.time_s, DVec3(0.4), DVec3(0.6)));
  CHECK_FALSE(source.covers(frame.time_s, DVec3(0.4), DVec3(1.6)));
  REQUIRE(source.hasNewer(0.26, frame.time_s));
  source.makeFrame(0.26, frame);
  CHECK(frame.size() == 0);
  CHECK_FALSE(source.covers(frame.time_s, DVec3(0.4), DVec3(0.6)));
}

TEST_CASE("a brick with changed points changes the contact only where the hand reaches it") {
  BrickSource source({.edge = 1, .points = 10});
  const auto brickAt = [](int x, float height) {
    auto brick = std::make_shared<Brick>();
    brick->ids = {static_cast<std::uint32_t>(x)};
    brick->positions = {Vec3(static_cast<float>(x) + 0.5f, 0.5f, height)};
    brick->normals = {Vec3(0, 0, 1)};
    BrickUpdate update;
    update.bricks.emplace_back(BrickGrid::keyOf(IVec3(x, 0, 0)), blockOf(brick));
    return update;
  };
  CHECK_FALSE(source.apply(brickAt(1, 0.5f)));  // without a hand
  HandReaches hands{.count = 1};
  hands.hands[0] = {.low = DVec3(0.4), .high = DVec3(1.6, 0.6, 0.6)};
  source.ask(hands);
  CHECK_FALSE(source.apply(brickAt(0, 0.5f)));  // not known before
  CHECK(source.apply(brickAt(0, 0.6f)));
  CHECK(source.apply(brickAt(1, 0.6f)));
  CHECK_FALSE(source.apply(brickAt(1, 0.6f)));  // again, unchanged
  CHECK_FALSE(source.apply(brickAt(2, 0.5f)));
  CHECK_FALSE(source.apply(brickAt(2, 0.6f)));  // no hand reaches it
  BrickUpdate again = brickAt(1, 0.7f);
  again.dropped = {again.bricks.front().first};
  CHECK(source.apply(std::move(again)));
}

TEST_CASE("too many points are refused, and nothing waits after the source was closed") {
  BrickSource source({.edge = 1, .points = 2});
  auto brick = std::make_shared<Brick>();
  brick->ids = {1, 2, 3};
  brick->positions.assign(3, Vec3(0.5f));
  brick->normals.assign(3, Vec3(0, 0, 1));
  BrickUpdate update;
  update.bricks.emplace_back(BrickGrid::keyOf(IVec3(0)), blockOf(brick));
  CHECK_THROWS_AS(source.apply(update), Error);
  source.giveUp();
  HandReaches hands{.count = 1};
  hands.hands[0] = {.low = DVec3(5), .high = DVec3(6)};
  CHECK_FALSE(source.await(hands, 60));
}

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
      const std::vector<PointState> made = madeStates(hand.source);
      std::vector<PointState> states = statesOf(scene.cloud);
      for (const PointState& state : made) states[state.number] = state;
      const PointCloud here = editedCloud(scene.cloud, states);
      CHECK(here.positions == sculpted.positions);
      CHECK(here.normals == sculpted.normals);
    }
}

TEST_CASE("a deep push of a plate whose bricks are joined leaves its far side, as in a whole cloud, bit by bit") {
  constexpr double kThickness = 1;
  Scene plate{.spacing = 0.5, .radius = 2};
  for (const double side : {1.0, -1.0})
    for (double y = -15; y <= 15; y += plate.spacing)
      for (double x = -20; x <= 20; x += plate.spacing) {
        plate.cloud.positions.emplace_back(Vec3(x, y, 0.5 * side * kThickness));
        plate.cloud.normals.emplace_back(0, 0, side);
      }
  // Under the larger brush some points wait for their turn.
  for (const double radius : {6.0, 12.0}) {
    CAPTURE(radius);
    const BrushOptions brush{
        .kind = BrushKind::push, .yieldDepth = 0.25, .pushRate = 0.3, .radius = radius, .resample = false};
    CpuTouch whole(plate.cloud, {.radius = plate.radius, .brush = brush, .threads = 1});
    BrickHand hand(plate, {.brush = brush});
    hand.source.apply(hand.bricks.whole(DVec3(-60), DVec3(60)));
    for (int tick = 0; tick < 200; ++tick) {
      const double down = std::min(1.0, tick / 80.0), aside = std::clamp((tick - 80) / 60.0, 0.0, 1.0);
      const Pose pose{.time_s = 1e-3 * tick, .hip = DVec3(4 * aside - 2, 0, 1 - 5 * down)};
      whole.query(pose, 0);
      hand.touch->query(pose, 0);
    }
    hand.touch->finish();
    whole.finish();
    PointCloud there = plate.cloud;
    CHECK(whole.readBack(there) > 100);
    const std::vector<PointState> made = madeStates(hand.source);
    std::vector<PointState> states = statesOf(plate.cloud);
    for (const PointState& state : made) states[state.number] = state;
    const PointCloud here = editedCloud(plate.cloud, states);
    CHECK(here.positions == there.positions);
    std::size_t pressed = 0, through = 0, far = 0, turned = 0;
    for (std::size_t i = 0; i < here.size(); ++i) {
      const bool isNear = i < here.size() / 2;
      pressed += isNear && here.positions[i].z < plate.cloud.positions[i].z - 0.3 * kThickness;
      through += isNear && here.positions[i].z < -0.5 * kThickness + 0.5 * plate.spacing;
      far += !isNear && here.positions[i] != plate.cloud.positions[i];
      turned += glm::dot(here.normals[i], plate.cloud.normals[i]) < 0.5f;
      // Components that are zero but for rounding depend on the order of the neighbours.
      CHECK(glm::distance(here.normals[i], there.normals[i]) < 1e-7f);
    }
    CHECK(pressed > 100);
    CHECK(through == 0);
    CHECK(far == 0);
    CHECK(turned == 0);
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
    whole.query(pose, 0);
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  // Edits that were postponed because other programs had the processor are made now.
  for (int i = 0; i < 1500; ++i) {
    hand.touch->query({.time_s = time_s += 1e-3, .hip = DVec3(0, 0, 46)}, kBudget_us);
  }
  hand.touch->finish();
  whole.finish();
  const std::size_t edits = hand.touch->report().editTimes_us.size();
  CHECK(edits > 20);
  CHECK(hand.touch->report().firstEdit_s.has_value());
  const std::vector<PointState> made = madeStates(hand.source);
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
    const Pose pose{.time_s = time_s += 1e-3, .hip = DVec3(0, 0, 44.5)};
    hand.touch->ask({&pose, 1}, kBudget_us);  // a tick that does not end brings no frame
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
  press(true);  // no brick is known
  hand.source.apply(hand.bricks.whole(DVec3(-70), DVec3(70)));
  press(false);
  hand.touch->setBrush(std::nullopt);
  press(true);
  hand.touch->finish();
  CHECK(madeStates(hand.source).empty());
  hand.touch->setBrush(brush);
  for (int i = 0; i < 60; ++i) hand.touch->query({.time_s = 1 + 1e-3 * i, .hip = DVec3(0, 0, 51 - 0.05 * i)}, 0);
  hand.touch->finish();
  CHECK(madeStates(hand.source).size() > 30);
  const BrickHand fixed(scene, {.fixed = "it is to be felt alone"});
  CHECK_THROWS_WITH_AS(fixed.touch->setBrush(brush), "it is to be felt alone", UsageError);
}

}  // namespace palpate::brick_touch_test
