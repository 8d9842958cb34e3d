// What a tool in water has to be true to.
#include <array>
#include <cmath>
#include <random>

#include "tests/matter/matter_truths.hpp"

namespace palpate {

namespace {

constexpr double kPi = 3.14159265358979323846;

double displacedBy(double radius_m) { return 1000 * 4 * kPi / 3 * radius_m * radius_m * radius_m; }

MatterScene tankForBall(double radius_mm, double side_spacings, double filled_spacings) {
  MatterScene scene = tank({side_spacings, filled_spacings + 8, side_spacings}, filled_spacings);
  scene.tool = {.radius_mm = radius_mm, .mass_kg = displacedBy(radius_mm * 1e-3)};
  return scene;
}

// At rest around a ball that is there already.
std::vector<Vec3> placesAround(const DVec3& ball_m, const MatterScene& scene) {
  std::vector<Vec3> places = placesAtRest(scene);
  std::erase_if(places, [&](const Vec3& place) {
    return glm::length(DVec3(place) - ball_m) < (scene.tool.radius_mm + 0.3 * scene.spacing_mm) * 1e-3;
  });
  return places;
}

}  // namespace

void checkBuoyancy(const MatterMaker& make, double radius_m, int settling, int steps) {
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
  CHECK(isWithin(0.03, reaction.y, expected));
  CHECK(isWithin(0.03, force.y, expected));
  CHECK(std::hypot(reaction.x, reaction.z) <= 0.03 * expected);
}

void checkRandomHands(const MatterMaker& make, int hands, int steps) {
  const MatterScene scene = tankForBall(30, 14, 9);
  std::mt19937 random(7);
  std::normal_distribution<double> push;
  for (int each = 0; each < hands; ++each) {
    const auto world = atRest(make, scene, 1);
    HandPose hand{.place_m = {0.07, 0.14, 0.07}};
    DVec3 speed(0);
    double least_J = 0;
    for (int k = 0; k < steps; ++k) {
      speed = 0.98 * speed - DVec3(0, 5e-3, 0);
      for (int axis = 0; axis < 3; ++axis) speed[axis] += 0.05 * push(random);
      hand.place_m = glm::clamp(hand.place_m + kMatterStep_s * speed, DVec3(0.03), DVec3(0.11, 0.14, 0.11));
      world->step({&hand, 1});
      least_J = std::min(least_J, world->portEnergy_J(0));
    }
    REQUIRE(world->state() == MatterState::running);
    CHECK(least_J >= -1e-3);
    CHECK(world->portEnergy_J(0) > 1e-3);
  }
}

void checkReactions(const MatterMaker& make, int steps) {
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
  CHECK(missingMomentum(*world) <= 1e-5);
}

}  // namespace palpate
