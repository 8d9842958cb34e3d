// Poses found on the GPU against those found on the host, and against the true ones.
#include <algorithm>
#include <array>

#include "engine/motion/fusion.hpp"
#include "engine/motion/pose_search_pass.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/motion_gpu/fused_cloud.hpp"
#include "tests/near.hpp"

namespace palpate::pose_search_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

const DVec3 kTable(0, 0, 0.02);

CameraPose onTheWay(std::uint64_t frame) { return onArc(kTable, 1.0, 0.4 + 0.01 * static_cast<double>(frame)); }

double shift_mm(const CameraPose& a, const CameraPose& b) { return 1000 * glm::distance(a.centre, b.centre); }

double turn_deg(const CameraPose& a, const CameraPose& b) {
  const DQuat turn = glm::conjugate(a.turn) * b.turn;
  return 2 * std::asin(std::min(1.0, glm::length(DVec3(turn.x, turn.y, turn.z)))) * 180 / 3.14159265358979;
}

class PoseFixture : public GpuFixture {};

}  // namespace

TEST_CASE_FIXTURE(PoseFixture, "the GPU finds the pose that the host finds, frame after frame, near the true one") {
  const FusionOptions options = smallMap(60'000);
  const DepthScene scene = tableScene();
  FrameFusion host(options);
  FusedCloud gpu(device, smallCamera(), options);
  PoseSearchPass search(device, device.throughputQueue(), gpu.pass(), gpu.cloud());
  CameraPose last = onTheWay(0);
  for (std::uint64_t i = 0; i < 5; ++i) {
    CAPTURE(i);
    DepthFrame frame = scene.frame(smallCamera(), onTheWay(i), 1, i);
    if (i > 0) {
      const FrameImages& images = gpu.put(smallCamera(), frame, last);
      const IcpResult result = search.find(images, last, DVec3(0));
      CHECK_MESSAGE(result.state == IcpState::found, result.why());
      frame.pose.reset();
      const FrameOutcome& outcome = host.fuse(smallCamera(), frame);
      REQUIRE(outcome.fate == FrameFate::fused);
      // Compared for one step, since each continues from its own pose.
      CHECK(shift_mm(result.pose, outcome.pose) < 0.2);
      CHECK(turn_deg(result.pose, outcome.pose) < 0.02);
      CHECK(result.matched == near(outcome.search.matched, 0.01));
      CHECK(result.residual == near(outcome.search.residual, 0.02));
      CHECK(result.weakest == near(outcome.search.weakest, 0.05));
      CHECK(result.feigned == near(outcome.search.feigned, 0.05));
      CHECK(shift_mm(result.pose, onTheWay(i)) < 3);
      CHECK(turn_deg(result.pose, onTheWay(i)) < 0.3);
      frame.pose = last = result.pose;
      gpu.fuse(smallCamera(), frame);
    } else {
      host.fuse(smallCamera(), frame);
      gpu.fuse(smallCamera(), frame);
    }
  }
}

TEST_CASE_FIXTURE(PoseFixture, "the same frame gives the same pose; a plane or an empty frame gives none") {
  const FusionOptions options = smallMap(40'000);
  DepthScene plane;
  plane.add("plane", 3, DVec3(0));
  const DepthScene scene = tableScene();
  FusedCloud table(device, smallCamera(), options), flat(device, smallCamera(), options);
  PoseSearchPass onTable(device, device.latencyQueue(), table.pass(), table.cloud());
  PoseSearchPass onPlane(device, device.latencyQueue(), flat.pass(), flat.cloud());
  const CameraPose pose = onTheWay(0);
  CameraPose expected = pose;
  expected.centre += DVec3(0.01, 0, 0.005);
  table.fuse(smallCamera(), scene.frame(smallCamera(), pose, 1, 1));
  flat.fuse(smallCamera(), plane.frame(smallCamera(), pose, 1, 1));
  const DepthFrame frame = scene.frame(smallCamera(), pose, 1, 2);
  std::array<IcpResult, 2> results;
  for (IcpResult& result : results)
    result = onTable.find(table.put(smallCamera(), frame, expected), expected, DVec3(0));
  CHECK(results[0].state == IcpState::found);
  CHECK(results[0].pose.centre == results[1].pose.centre);
  CHECK(results[0].pose.turn == results[1].pose.turn);

  const DepthFrame again = plane.frame(smallCamera(), pose, 1, 2);
  const IcpResult slid = onPlane.find(flat.put(smallCamera(), again, expected), expected, DVec3(0));
  CHECK_MESSAGE(slid.state == IcpState::degenerate, slid.why());
  DepthFrame nothing = again;
  std::ranges::fill(nothing.depth_m, 0.0f);
  const IcpResult none = onPlane.find(flat.put(smallCamera(), nothing, expected), expected, DVec3(0));
  CHECK_MESSAGE(none.state == IcpState::tooFewMatches, none.why());
}

TEST_SUITE_END();

}  // namespace palpate::pose_search_test
