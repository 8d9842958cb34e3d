// Hands that press on soft bodies on the GPU: physical checks, and against the CPU.

#include "engine/cloud/analytic_shape.hpp"
#include "engine/matter/soft_scan.hpp"
#include "tests/labels.hpp"
#include "tests/matter/pressing_hand.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"
#include "tests/matter_gpu/gpu_soft.hpp"

namespace palpate::small_press_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

MatterScene blockOf(const DVec3& cells) {
  return {.matter = Matter::soft,
          .box_mm = cells * 5.0 + DVec3(20),
          .fill_mm = cells * 5.0,
          .spacing_mm = 5,
          .viscosity_Pa_s = 3,
          .young_Pa = 2e4,
          .gravity_m_s2 = {1, -7, 2}};
}

// Both are pressed at positions on the CPU's surface.
void checkPressedAlike(Device& device, const MatterScene& scene, std::vector<PressingHand> hands, int steps,
                       const SoftSolid* solid = nullptr, std::span<const SurfacePlace> points = {}) {
  const auto gpu = softOnGpu(device)(scene, 0, solid, points), cpu = softOnCpu()(scene, 0, solid, points);
  double most_N = 0;
  for (int k = 0; k < steps; ++k) {
    std::vector<SurfacePress> presses;
    for (std::size_t i = 0; i < hands.size(); ++i)
      presses.push_back(hands[i].goTo(hands[i].press().handTo_m -
                                      (2e-4 + 3e-5 * static_cast<double>(i)) * hands[i].press().normal +
                                      DVec3(1e-5, 0, 2e-5)));
    gpu->press(presses);
    cpu->press(presses);
    gpu->step();
    cpu->step();
    REQUIRE(gpu->pressed().size() == hands.size());
    for (std::size_t i = 0; i < hands.size(); ++i) {
      const PressReport &is = gpu->pressed()[i], &expected = cpu->pressed()[i];
      const double force = glm::length(expected.force_N) + 1e-3;
      most_N = std::max(most_N, force);
      REQUIRE(glm::distance(is.force_N, expected.force_N) < 2e-3 * force);
      REQUIRE(glm::distance(is.impulse, expected.impulse) < 2e-3 * kMatterStep_s * force);
      REQUIRE(std::abs(is.work_J - expected.work_J) < 2e-3 * std::abs(expected.work_J) + 1e-9);
      REQUIRE(glm::distance(is.place_m, expected.place_m) < 1e-6);
      hands[i].heard(expected);
    }
  }
  CHECK(most_N > 0.01);
  checkAlike(*gpu, *cpu,
             {.places_m = 1e-6,
              .kinetic = 1e-3,
              .compression = 1e-5,
              .leastForce_N = 0.001,
              .arm_m = 0.01,
              .energyShare = 0,
              .energy_J = 1e-7});
}

DVec3 topOf(const MatterScene& scene) { return 1e-3 * DVec3(scene.box_mm.x / 2, scene.fill_mm.y, scene.box_mm.z / 2); }

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "soft bodies of any size yield to a press on the GPU as on the CPU") {
  for (const DVec3& cells : {DVec3(1, 1, 1), DVec3(3, 1, 1), DVec3(31, 7, 3)}) {
    CAPTURE(cells.x);
    const MatterScene scene = blockOf(cells);
    checkPressedAlike(device, scene, {PressingHand(topOf(scene) + DVec3(0.0011, 0, 0.0007), 0.0061)}, 6);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "several hands that share nodes, saturate and slide press on the GPU as on the CPU") {
  MatterScene scene = blockOf({9, 4, 8});
  const auto handsOn = [&](std::size_t count) {
    std::vector<PressingHand> hands;
    for (std::size_t i = 0; i < count; ++i) {
      hands.emplace_back(topOf(scene) + DVec3(0.0031 * static_cast<double>(i) - 0.009, 0, 0.002 * (i % 3 - 1.0)),
                         0.0063, static_cast<std::uint32_t>(i / 2));
      hands.back().press().most_N = i < 2 ? 0.02 : 5;
      hands.back().press().friction = 0.2 * static_cast<double>(i);
    }
    return hands;
  };
  checkPressedAlike(device, scene, handsOn(2), 5);
  checkPressedAlike(device, scene, handsOn(5), 6);
  scene.pinned_mm = {DVec3(0), DVec3(33, 100, 33)};
  checkPressedAlike(device, scene, handsOn(3), 6);
}

TEST_CASE_FIXTURE(GpuFixture, "a scan is pressed on the GPU as on the CPU, also by wide and distant presses") {
  MatterScene scene = blockOf({24, 8, 24});
  scene.spacing_mm = 7;
  std::vector<SurfacePlace> points = placeScan(sampleShape(*makeShape("torus"), {.count = 3000}), scene);
  WorkerTeam team(2);
  const SoftSolid solid = scanSolid(points, scene.spacing_mm * 1e-3, 0, team);
  std::vector<PressingHand> hands;
  for (const std::size_t i : {std::size_t{17}, std::size_t{1200}}) {
    hands.emplace_back(DVec3(points[i].rest), i == 17 ? 0.03 : 0.0082, static_cast<std::uint32_t>(i));
    hands.back().press().normal = DVec3(points[i].normal);
  }
  // So far away that only the nearest position is pressed.
  hands.emplace_back(DVec3(points[600].rest) + 0.02 * DVec3(points[600].normal), 0.0072, 9);
  hands.back().press().normal = DVec3(points[600].normal);
  checkPressedAlike(device, scene, hands, 5, &solid, points);
}

TEST_SUITE_END();

}  // namespace palpate::small_press_test
