// A ball between a hand and water, on each back end.
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <random>

#include "engine/core/named_values.hpp"
#include "engine/matter/tool_body.hpp"
#include "tests/labels.hpp"
#include "tests/matter/on_matter.hpp"
#include "tests/near.hpp"

namespace palpate::tool_truths_test {

namespace {

double displacedBy(double radius_m) { return 1000 * 4 * std::numbers::pi / 3 * radius_m * radius_m * radius_m; }

MatterScene tankForBall(double radius_mm, double side_spacings, double filled_spacings) {
  MatterScene scene = tank({side_spacings, filled_spacings + 8, side_spacings}, filled_spacings);
  scene.tool = {.radius_mm = radius_mm, .mass_kg = displacedBy(radius_mm * 1e-3)};
  return scene;
}

// Positions at rest around a ball that is already there.
std::vector<Vec3> placesAround(const DVec3& ball_m, const MatterScene& scene) {
  std::vector<Vec3> places = placesAtRest(scene);
  std::erase_if(places, [&](const Vec3& place) {
    return glm::length(DVec3(place) - ball_m) < (scene.tool.radius_mm + 0.3 * scene.spacing_mm) * 1e-3;
  });
  return places;
}

}  // namespace

TEST_CASE_FIXTURE(OnMatter, "a ball in water has the buoyancy of the displaced water" * kMoreInFull * kFullOnGpu) {
  const int settling = onCpuOrGpu(400, 250), steps = onCpuOrGpu(300, 150);
  for (const double radius_m : onCpuOrGpu(byTier<std::vector<double>>({0.03}, {0.03, 0.04}), {0.03})) {
    const MatterScene scene = tankForBall(radius_m * 1e3, 12, 12);
    const HandPose hand{.place_m = {0.06, 0.06, 0.06}};
    const auto world = make(scene, 1, placesAround(hand.place_m, scene));
    DVec3 reaction(0), force(0);
    for (int k = 0; k < settling + steps; ++k) {
      world->step({&hand, 1});
      if (k < settling) continue;
      reaction += world->answers()[0].reaction_N / double(steps);
      force += world->answers()[0].force_N / double(steps);
    }
    REQUIRE(world->state() == MatterState::running);
    const double expected = displacedBy(radius_m) * kGravity_m_s2;
    checkTruth(fmt::format("buoyancy of a ball of {:g} spacings' radius, N", radius_m * 1e3 / scene.spacing_mm),
               reaction.y, expected, 0.03);
    checkTruth("the same as its hand feels it, N", force.y, expected, 0.03);
    CHECK(std::hypot(reaction.x, reaction.z) <= 0.03 * expected);
  }
}

namespace {

void checkRandomHands(const MatterMaker& make, Matter matter, double gain, int hands, int steps) {
  MatterScene scene = tankForBall(30, 14, 9);
  scene.matter = matter;
  scene.gain = gain;
  if (matter == Matter::sand) scene.density_kg_m3 = 1600;
  std::mt19937 random(7);
  std::normal_distribution<double> push;
  double min_J = 0;
  for (int each = 0; each < hands; ++each) {
    const auto world = atRest(make, scene, 1);
    HandPose hand{.place_m = {0.07, 0.14, 0.07}};
    DVec3 speed(0);
    for (int k = 0; k < steps; ++k) {
      speed = 0.98 * speed - DVec3(0, 5e-3, 0);
      for (int axis = 0; axis < 3; ++axis) speed[axis] += 0.05 * push(random);
      hand.place_m = glm::clamp(hand.place_m + kMatterStep_s * speed, DVec3(0.03), DVec3(0.11, 0.14, 0.11));
      world->step({&hand, 1});
      min_J = std::min(min_J, world->portEnergy_J(0));
    }
    REQUIRE(world->state() == MatterState::running);
    CHECK(world->portEnergy_J(0) > 1e-3);
  }
  const double coupling_N_mm = 1e-3 * couplingStiffness_N_m(scene);
  checkAtMost(fmt::format("energy that random hands get out of {}, gain {:g}, {:.3g} N/mm, in mJ",
                          nameOf(kMatters, matter), gain, coupling_N_mm),
              1e3 * std::abs(min_J), 1);
}

}  // namespace

TEST_CASE_FIXTURE(OnMatter, "random hands gain no energy from water and sand, even with a force gain" * kMoreInFull *
                                kFullOnGpu) {
  if (!kOnGpu) checkRandomHands(make, Matter::water, 1, 1, byTier(300, 600));
  for (const Matter matter : {Matter::water, Matter::sand})
    checkRandomHands(make, matter, 50, onCpuOrGpu(byTier(1, 2), 1), onCpuOrGpu(byTier(300, 400), 150));
}

TEST_CASE_FIXTURE(OnMatter, "a hand's energy matches its force, also while the gain changes") {
  const int steps = onCpuOrGpu(300, 90);
  const double share = onCpuOrGpu(1e-9, 1e-4);
  MatterScene scene = tankForBall(30, 14, 9);
  const auto world = atRest(make, scene, 1);
  HandPose hand{.place_m = {0.07, 0.12, 0.07}};
  double against_J = 0, throughput_J = 0;
  for (int k = 0; k < steps; ++k) {
    if (k == steps / 3 || k == 2 * steps / 3) {
      scene.gain = k == steps / 3 ? 50 : 2;
      world->change(scene);
    }
    const DVec3 move = k == 0 ? DVec3(0) : DVec3(1e-4 * std::sin(0.05 * k), -3e-4 * std::sin(0.03 * k), 5e-5);
    hand.place_m += move;
    world->step({&hand, 1});
    const double work_J = -glm::dot(world->answers()[0].force_N, move);
    against_J += work_J;
    throughput_J += std::abs(work_J);
    REQUIRE(world->answers()[0].coupling_N_m == near(couplingStiffness_N_m(scene), 1e-6));
  }
  REQUIRE(world->state() == MatterState::running);
  REQUIRE(throughput_J > 1e-3);
  checkAtMost("energy at the port against force times way while the gain changes, share of all that went through",
              std::abs(world->portEnergy_J(0) - against_J) / throughput_J, share);
}

namespace {

// Torque on a ball that rotates in a tank of viscous water, relative to 8 pi mu R^3 omega, and the water's angular
// momentum after ten steps, before it reaches walls, relative to what the ball gave.
struct Turned {
  double share = 0, got = 0;
};

Turned turned(const MatterMaker& make, double viscosity_Pa_s, double spin_rad_s, int steps) {
  MatterScene scene = tankForBall(40, 14, 14);
  scene.box_mm.y = 140;
  scene.gravity_m_s2 = DVec3(0);
  scene.viscosity_Pa_s = viscosity_Pa_s;
  const DVec3 middle_m(0.07), axis(0, 1, 0);
  const auto world = make(scene, 1, placesAround(middle_m, scene));
  DVec3 torque(0), given(0), turning(0);
  for (int k = 0; k < steps; ++k) {
    const HandPose hand{.place_m = middle_m, .orientation = glm::angleAxis(kMatterStep_s * spin_rad_s * k, axis)};
    world->step({&hand, 1});
    const DVec3& now = world->answers()[0].torque_Nm;
    if (k < 10) given -= kMatterStep_s * now;
    if (k >= steps / 2) torque += now / double(steps - steps / 2);
    if (k != 9) continue;
    const std::vector<Vec3> places = world->positionsById(), velocities = world->velocitiesById();
    for (std::size_t i = 0; i < places.size(); ++i)
      turning += world->plan().mass_kg * glm::cross(DVec3(places[i]) - middle_m, DVec3(velocities[i]));
  }
  REQUIRE(world->state() == MatterState::running);
  CHECK(std::hypot(torque.x, torque.z) <= 0.05 * std::abs(torque.y));
  const double stokes_Nm =
      8 * std::numbers::pi * viscosity_Pa_s * std::pow(scene.tool.radius_mm * 1e-3, 3) * spin_rad_s;
  return {.share = -torque.y / stokes_Nm, .got = turning.y / given.y};
}

}  // namespace

TEST_CASE_FIXTURE(OnMatter, "viscous water resists the rotation of a ball" * kFullOnGpu) {
  const int steps = onCpuOrGpu(400, 150);
  const Turned slow = turned(make, 1, 0.5, steps), swift = turned(make, 1, 1, steps), thick = turned(make, 5, 1, steps);
  // At this resolution a ball drags only the water that its points meet, and their reaction acts on water slightly
  // farther out.
  for (const Turned& each : {slow, swift, thick}) {
    MESSAGE(fmt::format("torque on a turning ball of 4 spacings: {:.2f} of 8 pi mu R^3 omega; water gets {:.2f} of it",
                        each.share, each.got));
    CHECK(each.share > 0.4);
    CHECK(each.share < onCpuOrGpu(0.6, 0.7));
    CHECK(each.got > 1);
    CHECK(each.got < 1.4);
  }
  checkTruth("the same over omega, at twice the spin", swift.share, slow.share, 0.02);
  checkTruth("the same over mu, at five times the viscosity", thick.share, swift.share, 0.3);
}

TEST_CASE_FIXTURE(OnMatter, "a ball receives the momentum that the water loses" * kFullOnGpu) {
  const int steps = onCpuOrGpu(300, 160);
  const MatterScene scene = tankForBall(30, 14, 9);
  const auto world = atRest(make, scene, 2);
  std::array<HandPose, 2> hands{HandPose{.place_m = {0.035, 0.14, 0.07}}, HandPose{.place_m = {0.105, 0.14, 0.07}}};
  DVec3 reactions(0);
  for (int k = 0; k < steps; ++k) {
    hands[0].place_m.y -= 3e-4;
    hands[1].place_m.y -= 2e-4;
    world->step(hands);
    reactions += kMatterStep_s * (world->answers()[0].reaction_N + world->answers()[1].reaction_N);
  }
  REQUIRE(world->state() == MatterState::running);
  const MatterImpulses& given = world->impulses();
  CHECK(glm::length(given.onTools) > 0.01);
  CHECK(glm::length(given.onTools - reactions) <= 1e-9 * glm::length(reactions));
  checkAtMost("momentum that nobody gave with two balls, of what gravity gave", missingMomentum(*world), 1e-5);
}

}  // namespace palpate::tool_truths_test
