// A soft body in its box, with hands.
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "engine/matter/soft_scene.hpp"
#include "engine/matter/soft_world.hpp"
#include "tests/matter/matter_scenes.hpp"

namespace palpate {

namespace {

MatterScene jelly() {
  return {.matter = Matter::soft,
          .box_mm = {100, 120, 100},
          .fill_mm = {50, 40, 50},
          .spacing_mm = 5,
          .viscosity_Pa_s = 3,
          .young_Pa = 3e4,
          .tool = {.radius_mm = 12, .mass_kg = 0.02}};
}

void run(SoftWorld& world, int steps) {
  for (int k = 0; k < steps; ++k) world.step();
  REQUIRE(world.state() == MatterState::running);
}

bool sameBytes(const SoftWorld& a, const SoftWorld& b) {
  const auto same = [](std::span<const Vec3> x, std::span<const Vec3> y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size_bytes()) == 0;
  };
  return same(a.body().displacements(), b.body().displacements()) && same(a.body().velocities(), b.body().velocities());
}

}  // namespace

TEST_CASE("a block that lies on the floor weighs what it weighs, comes to rest, and sinks by its own weight alone") {
  SoftWorld world(jelly());
  run(world, 1500);
  const DVec3 before = world.impulses().onWalls;
  run(world, 200);
  const double weight = 0.05 * 0.05 * 0.04 * 1000 * kGravity_m_s2;
  CHECK(isWithin(0.01, -(world.impulses().onWalls - before).y / 0.2, weight));
  CHECK(world.observe().kinetic_J < 1e-9);
  CloudFrame frame;
  world.makeFrame(frame);
  double top = 0, bottom = 1;
  for (const Vec3& position : frame.positions) {
    top = std::max(top, static_cast<double>(position.y));
    bottom = std::min(bottom, static_cast<double>(position.y));
  }
  // rho g H^2 / 2 E where sides are free to bulge.
  const double sunk = 1000 * kGravity_m_s2 * 0.04 * 0.04 / (2 * 3e4);
  CHECK(std::abs(0.04 - top - sunk) < 0.4 * sunk);
  CHECK(bottom > -5e-5);
}

TEST_CASE("a block on a slope stays where friction holds it, and otherwise slides as Coulomb says") {
  for (const double friction : {0.3, 0.8}) {
    MatterScene scene = jelly();
    scene.box_mm.x = 600;
    scene.young_Pa = 1e5;
    scene.viscosity_Pa_s = 20;
    scene.friction = friction;
    scene.gravity_m_s2 = kGravity_m_s2 * DVec3(std::sin(0.5), -std::cos(0.5), 0);  // tan is 0.55
    SoftWorld world(scene);
    const auto speed = [&] { return world.observe().momentum.x / world.body().mass_kg(); };
    run(world, 100);
    const double before = speed();
    run(world, 100);
    const double expected = kGravity_m_s2 * std::max(std::sin(0.5) - friction * std::cos(0.5), 0.0);
    CHECK(std::abs((speed() - before) / 0.1 - expected) < 0.25);
  }
}

TEST_CASE("what is pushed and let go returns to where it was") {
  MatterScene scene = jelly();
  scene.gravity_m_s2 = DVec3(0);
  scene.pinned_mm = {DVec3(0), DVec3(100, 0.1, 100)};
  SoftWorld world(scene, {.tools = 1});
  const DVec3 above(0.05, 0.06, 0.05);
  double deepest = 0;
  for (int k = 0; k < 3000; ++k) {
    const double down = k < 500 ? 2.4e-2 * std::sin(3.1416 * k / 500) : 0;
    const HandPose hand{.place_m = above - DVec3(0, down, 0)};
    world.step({&hand, 1});
    deepest = std::max(deepest, world.observe().maxCompression);
  }
  REQUIRE(world.state() == MatterState::running);
  CHECK(deepest > 0.05);
  const MatterImpulses& given = world.impulses();
  CHECK(given.onTools.y > 0.01);
  CHECK(glm::length(world.observe().momentum + given.onWalls + given.onTools) <= 1e-5 * glm::length(given.onTools));
  for (const Vec3& moved : std::as_const(world).body().displacements()) REQUIRE(glm::length(moved) < 1e-6f);
}

TEST_CASE("a fallen body bounces, and its momentum is what gravity gave less what the walls took") {
  MatterScene scene = jelly();
  scene.shape = SoftShape::ball;
  scene.viscosity_Pa_s = 0.5;
  SoftWorld world(scene);
  for (Vec3& velocity : world.body().velocities()) velocity = {0.6f, 0.8f, 0};
  const double mass = world.body().mass_kg();
  const DVec3 before = mass * DVec3(Vec3(0.6f, 0.8f, 0));
  for (int k = 0; k < 500; ++k) {
    run(world, 1);
    const MatterImpulses& given = world.impulses();
    const DVec3 missing = world.observe().momentum - (before + given.gravity - given.onWalls);
    REQUIRE(glm::length(missing) <= 1e-5 * (glm::length(before) + glm::length(given.gravity)));
  }
  CHECK(world.impulses().onWalls.y < -0.1 * mass);
  CHECK(world.impulses().onWalls.x > 0.1 * mass);
  CHECK(isWithin(0.01, mass, 4.18879 * std::pow(0.02, 3) * 1000));
}

TEST_CASE("what a ball got is what the body lost, and the hand feels that") {
  SoftWorld world(jelly(), {.tools = 2});
  std::array<HandPose, 2> hands{HandPose{.place_m = {0.035, 0.055, 0.05}}, HandPose{.place_m = {0.07, 0.055, 0.05}}};
  DVec3 reactions(0);
  for (int k = 0; k < 600; ++k) {
    for (HandPose& hand : hands) hand.place_m.y -= k < 200 ? 4e-5 : 0;
    world.step(hands);
    reactions += kMatterStep_s * (world.answers()[0].reaction_N + world.answers()[1].reaction_N);
  }
  REQUIRE(world.state() == MatterState::running);
  const MatterImpulses& given = world.impulses();
  CHECK(given.onTools.y > 0.01);
  CHECK(glm::length(given.onTools - reactions) <= 1e-9 * glm::length(reactions));
  const DVec3 missing = world.observe().momentum - (given.gravity - given.onWalls - given.onTools);
  CHECK(glm::length(missing) <= 1e-5 * (glm::length(given.gravity) + glm::length(given.onTools)));
  for (const ToolAnswer& answer : world.answers()) {
    CHECK(answer.reaction_N.y > 0.01);
    CHECK(isWithin(0.02, answer.force_N.y, answer.reaction_N.y));
  }
}

TEST_CASE("random hands get no energy out of a soft body") {
  std::mt19937 random(7);
  std::normal_distribution<double> push;
  for (int hands = 0; hands < 3; ++hands) {
    MatterScene scene = jelly();
    scene.viscosity_Pa_s = hands == 0 ? 0 : 3;
    SoftWorld world(scene, {.tools = 1});
    HandPose hand{.place_m = {0.05, 0.056, 0.05}};
    DVec3 speed(0);
    double least_J = 0, most_N = 0;
    for (int k = 0; k < 1200; ++k) {
      speed = 0.98 * speed - DVec3(0, 4e-3, 0);
      for (int axis = 0; axis < 3; ++axis) speed[axis] += 0.05 * push(random);
      hand.place_m = glm::clamp(hand.place_m + kMatterStep_s * speed, DVec3(0.03, 0.03, 0.03), DVec3(0.07, 0.08, 0.07));
      world.step({&hand, 1});
      least_J = std::min(least_J, world.portEnergy_J(0));
      most_N = std::max(most_N, glm::length(world.answers()[0].reaction_N));
    }
    REQUIRE(world.state() == MatterState::running);
    CHECK(least_J >= -1e-3);
    CHECK(most_N > 0.3);
  }
}

TEST_CASE("a body is as stiff with more substeps") {
  // Force over the depth to the power of Hertz: what holds the ball gives way by the substep (tool_body.cpp).
  const auto stiffnessOf = [](std::uint32_t substeps) {
    MatterScene scene = jelly();
    scene.substeps = substeps;
    scene.gravity_m_s2 = DVec3(0);
    scene.pinned_mm = {DVec3(0), DVec3(100, 0.1, 100)};
    SoftWorld world(scene, {.tools = 1});
    HandPose hand{.place_m = {0.05, 0.0525, 0.05}};
    for (int k = 0; k < 700; ++k) {
      hand.place_m.y -= k < 200 ? 2.5e-5 : 0;
      world.step({&hand, 1});
    }
    REQUIRE(world.state() == MatterState::running);
    const ToolAnswer& answer = world.answers()[0];
    CHECK(answer.reaction_N.y > 0.1);
    return answer.reaction_N.y / std::pow(0.04 + 0.012 - answer.place_m.y, 1.5);
  };
  const double needed = stiffnessOf(0);
  CHECK(isWithin(2e-3, stiffnessOf(2 * planOf(jelly()).substeps), needed));
  CHECK(isWithin(2e-3, stiffnessOf(5 * planOf(jelly()).substeps), needed));
}

TEST_CASE("how a surface gives way is that of a half-space, and that of the mass where nothing holds it") {
  MatterScene scene = jelly();
  scene.box_mm = {200, 200, 200};
  scene.fill_mm = {130, 100, 130};
  scene.pinned_mm = {DVec3(0), DVec3(200, 0.1, 200)};
  scene.poisson = 0.3;
  SoftWorld deep(scene);
  // Mean displacement under an even pressure on a circle (Love 1929), less that of what would lie below the block
  // (Boussinesq 1885).
  constexpr double kRadius_m = 0.0125;
  const double expected =
      16 * (1 - 0.3 * 0.3) / (3 * 9.8696 * 3e4 * kRadius_m) - (1 + 0.3) * (3 - 2 * 0.3) / (2 * 3.1416 * 3e4 * 0.1);
  CHECK(isWithin(0.05, deep.localCompliance_m_N({0.1, 0.1, 0.1}, kRadius_m, {0, -1, 0}), expected));
  CHECK(sameBytes(deep, SoftWorld(scene)));
  MatterScene free = jelly();
  free.gravity_m_s2 = DVec3(0);
  SoftWorld floating(free);
  const double byMass = 1 / (16 * floating.body().mass_kg());
  CHECK(isWithin(0.03, floating.localCompliance_m_N({0.05, 0.04, 0.05}, 1, {0, -1, 0}), byMass));
  SoftWorld standing(jelly());
  run(standing, 300);
  CHECK(standing.localCompliance_m_N({0.05, 0.04, 0.05}, 1, {0, -1, 0}) < 0.05 * byMass);
}

TEST_CASE("a world of a soft body has the same bytes with one thread and with three, and after it was begun again") {
  SoftWorld one(jelly(), {.threads = 1, .tools = 1}), three(jelly(), {.threads = 3, .tools = 1});
  const auto press = [](SoftWorld& world) {
    HandPose hand{.place_m = {0.05, 0.053, 0.05}};
    for (int k = 0; k < 150; ++k) {
      hand.place_m.y -= 5e-5;
      world.step({&hand, 1});
    }
  };
  press(one);
  press(three);
  CHECK(sameBytes(one, three));
  CHECK(one.answers()[0].force_N == three.answers()[0].force_N);
  CHECK(one.observe().momentum == three.observe().momentum);
  CloudFrame a, b;
  one.makeFrame(a);
  three.makeFrame(b);
  CHECK(a.positions == b.positions);
  CHECK(a.normals == b.normals);
  one.reset();
  press(one);
  CHECK(sameBytes(one, three));
}

TEST_CASE("a soft body that diverges says so, has no force from then on, and can be begun again") {
  for (const float velocity : {1e6f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    SoftWorld world(jelly(), {.tools = 1});
    const HandPose hand{.place_m = {0.05, 0.045, 0.05}};
    for (int k = 0; k < 10; ++k) world.step({&hand, 1});
    CHECK(world.answers()[0].force_N.y > 0);
    for (Vec3& v : world.body().velocities()) v.x = velocity;
    world.step({&hand, 1});
    CHECK(world.state() == MatterState::diverged);
    CHECK(world.answers()[0].force_N == DVec3(0));
    CHECK(world.answers()[0].reaction_N == DVec3(0));
    world.reset();
    CHECK(world.state() == MatterState::running);
    SoftWorld fresh(jelly(), {.tools = 1});
    for (int k = 0; k < 5; ++k) {
      world.step({&hand, 1});
      fresh.step({&hand, 1});
    }
    CHECK(sameBytes(world, fresh));
  }
}

TEST_CASE("a hand that jumps across the box gives a bounded force or ends the simulation, never what is no number") {
  SoftWorld world(jelly(), {.tools = 1});
  for (int k = 0; k < 200; ++k) {
    const HandPose hand{.place_m = {0.05, k % 20 == 10 ? 1e3 : 0.05, 0.05}};
    world.step({&hand, 1});
    REQUIRE(isFinite(world.answers()[0].force_N));
    REQUIRE(isFinite(world.answers()[0].reaction_N));
  }
}

TEST_CASE("a scene of a soft body that cannot be simulated is refused with its field") {
  const auto with = [](auto change) {
    MatterScene scene = jelly();
    change(scene);
    return refusal(scene);
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  CHECK(refusal(jelly()) == "taken");
  const auto begins = [](const std::string& text, const std::string& field) { return text.starts_with(field); };
  CHECK(begins(with([](MatterScene& s) { s.young_Pa = -1; }), "young_Pa: is -1;"));
  CHECK(begins(with([](MatterScene& s) { s.young_Pa = kNaN; }), "young_Pa: is nan;"));
  CHECK(begins(with([](MatterScene& s) { s.poisson = 0.5; }), "poisson: is 0.5;"));
  CHECK(begins(with([](MatterScene& s) { s.poisson = -0.1; }), "poisson: is -0.1;"));
  CHECK(begins(with([](MatterScene& s) { s.viscosity_Pa_s = -1; }), "viscosity_Pa_s: is -1;"));
  CHECK(begins(with([](MatterScene& s) { s.young_Pa = 1e9, s.spacing_mm = 1; }), "spacing_mm: needs"));
  CHECK(begins(with([](MatterScene& s) { s.spacing_mm = 0.1; }), "spacing_mm: makes 100651401 nodes"));
  CHECK(begins(with([](MatterScene& s) { s.fill_mm.y = 2; }), "fill_mm: is 2 along y"));
  CHECK(begins(with([](MatterScene& s) { s.substeps = 1; }), "substeps: is 1; this scene needs"));
  CHECK(begins(with([](MatterScene& s) { s.pinned_mm = {DVec3(0, 5, 0), DVec3(9, 4, 9)}; }), "pinned_mm: begins at 5"));
  CHECK(begins(with([](MatterScene& s) { s.shape = SoftShape::ball, s.fill_mm.y = 8; }), "fill_mm: is 8"));
  CHECK(begins(with([](MatterScene& s) { s.shape = SoftShape::ball, s.model = "a.ply"; }), "shape: belongs"));
}

}  // namespace palpate
