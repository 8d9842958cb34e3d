// Required accuracy of a model in matter, and of a ball that starts inside matter.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/matter/matter_truths.hpp"

namespace palpate {

namespace {

constexpr DVec3 kMiddle_m{0.07, 0.06, 0.07};  // centre of the model

double farthestOut(const MatterSimulation& world) {
  double out = 0;
  for (const Vec3& place : world.positionsById())
    for (int axis = 0; axis < 3; ++axis)
      out = std::max({out, -static_cast<double>(place[axis]),
                      static_cast<double>(place[axis]) - world.scene().box_mm[axis] * 1e-3});
  return out;
}

}  // namespace

MatterScene modelInTank(std::string_view shape, double size_mm, Matter matter) {
  MatterScene scene = tank({14, 18, 14}, 14);
  scene.matter = matter;
  scene.model = "builtin:" + std::string(shape);
  scene.model_mm = DVec3(size_mm);
  scene.model_at_mm = kMiddle_m * 1e3 - DVec3(0, size_mm / 2, 0);
  return scene;
}

std::size_t withinBall(const MatterSimulation& world, const DVec3& middle_m, double radius_m) {
  const std::vector<Vec3> places = world.positionsById();
  return static_cast<std::size_t>(std::ranges::count_if(
      places, [&](const Vec3& place) { return glm::length(DVec3(place) - middle_m) < radius_m; }));
}

void checkModelDisplaces(const MatterMaker& make, int settling, int steps) {
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

void checkModelKeepsOut(const MatterMaker& make, const MatterScene& scene, int steps) {
  // Water that falls onto the model in an otherwise empty tank.
  std::vector<Vec3> places;
  for (int z = 0; z < 12; ++z)
    for (int y = 0; y < 7; ++y)
      for (int x = 0; x < 12; ++x) places.emplace_back(Vec3(x, y, z) * 0.01f + Vec3(0.015f, 0.106f, 0.015f));
  const auto world = make(scene, 0, places);
  REQUIRE(world->leftOut() < places.size() / 4);
  for (int k = 0; k < steps; ++k) {
    run(*world, 1);
    REQUIRE(missingMomentum(*world) <= 1e-5);
    if (k % 10 != 9) continue;
    REQUIRE(world->insideModel() == 0);
    REQUIRE(farthestOut(*world) == 0);
  }
  CHECK(glm::length(world->impulses().onModel) > 0.01);
}

void checkBallBeginsInside(const MatterMaker& make, Matter matter, int steps) {
  MatterScene scene = tank({12, 18, 12}, 12);
  scene.matter = matter;
  const double radius_m = 0.03;
  scene.tool = {.radius_mm = radius_m * 1e3, .mass_kg = 4 * std::numbers::pi / 3 * 1000 * std::pow(radius_m, 3)};
  const HandPose hand{.place_m = {0.055, 0.055, 0.065}};  // a particle starts at its centre
  const auto world = atRest(make, scene, 1);
  const std::size_t within = withinBall(*world, hand.place_m, radius_m + 0.25 * 0.01);
  REQUIRE(within > 100);
  double most_J = 0, mostForce_N = 0;
  for (int k = 0; k < steps; ++k) {
    world->step({&hand, 1});
    REQUIRE(world->state() == MatterState::running);
    most_J = std::max(most_J, world->totals().kinetic_J);
    mostForce_N = std::max(mostForce_N, glm::length(world->answers()[0].force_N));
  }
  CHECK(world->pushedOut(0) == within);
  CHECK(world->particles() == 12 * 12 * 12);
  // No water is left inside; grains, which hold each other, may be inside by up to half of their size.
  CHECK(withinBall(*world, world->answers()[0].place_m, radius_m - (matter == Matter::sand ? 0.005 : 0)) == 0);
  CHECK(missingMomentum(*world) <= 1e-5);
  CHECK(world->portEnergy_J(0) >= -1e-3);
  if (matter == Matter::sand) return;
  CHECK(most_J < 0.1);  // of the 17 J of the ball at the speed of sound
  const double expected = scene.tool.mass_kg * kGravity_m_s2;
  CHECK(mostForce_N < 3 * expected);
  CHECK(isWithin(0.1, world->answers()[0].reaction_N.y, expected));
}

void checkBallStopsAtModel(const MatterMaker& make) {
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

}  // namespace palpate
