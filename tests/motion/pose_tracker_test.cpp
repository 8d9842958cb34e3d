// The pose assumed for a frame before its image is examined.
#include "engine/motion/frame_intake.hpp"

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
  FAIL("no pose search was expected");
  return {};
};

}  // namespace

TEST_CASE("a frame uses its own pose, and a first frame without a pose starts at the world's origin") {
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

TEST_CASE("the pose search starts at the last fused frame, and widens with each missed frame") {
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
