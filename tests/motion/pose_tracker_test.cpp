// Which pose a frame is taken to have, before anything is known of what it sees.
#include "engine/motion/pose_tracker.hpp"

#include <doctest/doctest.h>

#include "tests/near.hpp"

namespace palpate::pose_tracker_test {

namespace {

CameraPose at(double x) { return {.turn = DQuat(1, 0, 0, 0), .centre = DVec3(x, 0, 0)}; }

DepthFrame frameWith(std::optional<CameraPose> pose) {
  DepthFrame frame;
  frame.pose = pose;
  return frame;
}

const PoseTracker::Search kNever = [](const CameraPose&, const IcpOptions&) -> IcpResult {
  FAIL("there is nothing to look for");
  return {};
};

}  // namespace

TEST_CASE("a frame stands where it says, and the first one that does not say so in the middle of the world") {
  PoseTracker tracker;
  const auto first = tracker.place(frameWith({}), kNever);
  REQUIRE(first);
  CHECK(first->centre == DVec3(0));
  CHECK(first->turn == DQuat(1, 0, 0, 0));
  const auto given = tracker.place(frameWith(at(3)), kNever);
  REQUIRE(given);
  CHECK(given->centre == at(3).centre);
  CHECK(tracker.result().state == IcpState::found);
}

TEST_CASE("a frame is looked for about the last one that was fused, the farther the more were not") {
  IcpOptions options;
  options.longestStep_m = 0.1;
  options.largestTurn_deg = 5;
  PoseTracker tracker(options);
  tracker.fused(at(1));
  for (int missed = 0; missed < 3; ++missed) {
    const auto pose = tracker.place(frameWith({}), [&](const CameraPose& expected, const IcpOptions& now) {
      CHECK(expected.centre == at(1).centre);
      CHECK(now.longestStep_m == near(0.1 * (1 + missed), 1e-6));
      CHECK(now.largestTurn_deg == near(5.0 * (1 + missed), 1e-6));
      return IcpResult{.state = IcpState::tooFar};
    });
    CHECK_FALSE(pose);
    CHECK(tracker.result().state == IcpState::tooFar);
    tracker.missed();
  }
  tracker.fused(at(2));
  const auto pose = tracker.place(frameWith({}), [&](const CameraPose& expected, const IcpOptions& now) {
    CHECK(expected.centre == at(2).centre);
    CHECK(now.longestStep_m == near(0.1, 1e-6));
    return IcpResult{.state = IcpState::found, .pose = at(2.5)};
  });
  REQUIRE(pose);
  CHECK(pose->centre == at(2.5).centre);
  tracker.beginAt({});
  CHECK(tracker.place(frameWith({}), kNever)->centre == DVec3(0));
}

}  // namespace palpate::pose_tracker_test
