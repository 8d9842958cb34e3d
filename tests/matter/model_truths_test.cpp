// A model in water, on each back end.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/labels.hpp"
#include "tests/matter/on_matter.hpp"

namespace palpate::model_truths_test {

namespace {

constexpr DVec3 kMiddle_m{0.07, 0.06, 0.07};  // centre of the model

}  // namespace

TEST_CASE_FIXTURE(OnMatter, "a model in water has the buoyancy of the displaced water" * kFullOnGpu) {
  const int settling = onCpuOrGpu(400, 200), steps = onCpuOrGpu(300, 80);
  const MatterScene scene = modelInTank("sphere", 70);
  const auto world = atRest(make, scene);
  const double volume_m3 = 4 * std::numbers::pi / 3 * std::pow(0.035, 3);
  checkTruth("volume of a sphere that stands in water, cm^3", 1e6 * world->model()->volume_m3(), 1e6 * volume_m3, 0.01);
  CHECK(glm::length(world->model()->middle() - kMiddle_m) < 2e-4);
  CHECK(world->particles() + world->leftOut() == placesAtRest(scene).size());
  DVec3 force(0), torque(0);
  const DVec3 before = world->impulses().onModel;
  for (int k = 0; k < settling + steps; ++k) {
    run(*world, 1);
    if (k < settling) continue;
    force += world->onModel().force_N / double(steps);
    torque += world->onModel().torque_Nm / double(steps);
  }
  const double expected = volume_m3 * 1000 * kGravity_m_s2;
  checkTruth("buoyancy of that sphere, N", force.y, expected, 0.04);
  CHECK(std::hypot(force.x, force.z) <= 0.05 * expected);
  CHECK(glm::length(torque) <= 0.015 * expected * 0.035);  // an NVIDIA H100 has 0.0106
  CHECK(missingMomentum(*world) <= 1e-5);
  CHECK(glm::length(world->impulses().onModel - before) > 0.9 * expected * steps * kMatterStep_s);
}

TEST_CASE_FIXTURE(OnMatter, "no falling water enters a model, or passes the walls beside it" * kMoreInFull) {
  using Shapes = std::vector<const char*>;
  for (const char* shape :
       onCpuOrGpu(byTier<Shapes>({"cube"}, {"sphere", "cube", "torus", "sculpture"}), Shapes{"torus"})) {
    CAPTURE(std::string(shape));
    checkModelKeepsOut(make, modelInTank(shape, 80), onCpuOrGpu(400, byTier(90, 250)));
  }
}

TEST_CASE_FIXTURE(OnMatter,
                  "a ball is stopped by a model in the matter, slides along it, and releases no energy" * kFullOnGpu) {
  constexpr double kSphere_m = 0.03, kBall_m = 0.015;
  MatterScene scene{.box_mm = {120, 150, 120},
                    .fill_mm = {0, 0, 0},
                    .spacing_mm = 5,
                    .model = "builtin:sphere",
                    .model_mm = {60, 60, 60}};
  scene.tool = {.radius_mm = kBall_m * 1e3, .mass_kg = 0.05};
  const DVec3 middle(0.06, kSphere_m, 0.06), above = middle + DVec3(0, 0.06, 0);
  const auto world = make(scene, 1, {});
  for (const DVec3& way : {DVec3(0, -1, 0), glm::normalize(DVec3(1, -2, 0.5)), DVec3(0)}) {
    world->reset();
    HandPose hand{.place_m = above};
    if (way != DVec3(0)) hand.place_m = middle - 0.06 * way;
    double min_J = 0;
    const auto step = [&](const DVec3& move) {
      hand.place_m += move;
      world->step({&hand, 1});
      min_J = std::min(min_J, world->portEnergy_J(0));
    };
    for (int k = 0; k < 100; ++k) step(2.5e-4 * way);  // to 35 mm from the centre, then stays
    for (int k = 0; k < 300; ++k) step(DVec3(0));
    REQUIRE(world->state() == MatterState::running);
    const ToolAnswer& answer = world->answers()[0];
    if (way == DVec3(0)) {  // beside the sphere a ball feels nothing
      CHECK(answer.byModel_N == DVec3(0));
      CHECK(glm::length(answer.force_N) == 0);
      continue;
    }
    const DVec3 out = answer.place_m - middle;
    checkTruth("how near a ball comes to a sphere that stands, mm", 1e3 * glm::length(out), 1e3 * (kSphere_m + kBall_m),
               0.03);
    CHECK(glm::dot(glm::normalize(out), -way) > 0.999);
    // At rest the spring balances the model's force.
    CHECK(glm::length(answer.force_N) > 5);
    CHECK(glm::dot(glm::normalize(answer.force_N), -way) > 0.99);
    CHECK(glm::length(answer.byModel_N - answer.force_N) <= 0.01 * glm::length(answer.force_N));
    // Nothing holds it sideways, and it stays on the surface.
    const DVec3 side = glm::normalize(glm::cross(way, DVec3(0.3, 0.2, 1)));
    for (int k = 0; k < 100; ++k) {
      step(1e-4 * side);
      const double far_m = glm::length(world->answers()[0].place_m - middle);
      CHECK(far_m > 0.96 * (kSphere_m + kBall_m));
    }
    CHECK(glm::dot(world->answers()[0].place_m - middle - out, side) > 5e-3);
    for (int k = 0; k < 200; ++k) step(-5e-4 * way);
    CHECK(world->answers()[0].byModel_N == DVec3(0));
    CHECK(min_J >= -1e-3);
    CHECK(world->portEnergy_J(0) >= -1e-3);
  }
}

}  // namespace palpate::model_truths_test
