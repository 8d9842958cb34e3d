// A soft body in its box, with hands.
#include <cmath>
#include <limits>

#include "engine/matter/soft_scene.hpp"
#include "engine/matter/soft_world.hpp"
#include "tests/labels.hpp"
#include "tests/matter/soft_maker.hpp"

namespace palpate::soft_world_test {

TEST_CASE("a block on the floor has its weight, comes to rest, and sinks only by its own weight") {
  MatterScene scene = softBlock();
  scene.fill_mm = {30, 40, 30};
  SoftWorld world(scene);
  run(world, 1500);
  const DVec3 before = world.impulses().onWalls;
  run(world, 200);
  const double weight = 0.03 * 0.03 * 0.04 * 1000 * kGravity_m_s2;
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

TEST_CASE("a block on a slope sticks or slides by Coulomb's law") {
  for (const double friction : {0.3, 0.8}) {
    MatterScene scene = softBlock();
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

TEST_CASE("a body keeps its stiffness with more substeps" * kMoreInFull) {
  // Force over the depth to the power of Hertz: the spring that holds the ball yields per substep (tool_body.cpp).
  MatterScene block = softBlock();
  block.fill_mm = {30, 40, 30};
  block.gravity_m_s2 = DVec3(0);
  block.pinned_mm = {DVec3(0), DVec3(100, 0.1, 100)};
  const auto stiffnessOf = [&](std::uint32_t substeps) {
    MatterScene scene = block;
    scene.substeps = substeps;
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
  for (const std::uint32_t times : byTier<std::vector<std::uint32_t>>({2}, {2, 5}))
    checkTruth(fmt::format("force of a ball over d^1.5 with {} times the substeps", times),
               stiffnessOf(times * planOf(block).substeps), needed, 2e-3);
}

TEST_CASE("a soft scene that cannot be simulated is refused with the field's name") {
  const auto with = [](auto change) {
    MatterScene scene = softBlock();
    change(scene);
    return refusal(scene);
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  CHECK(refusal(softBlock()).empty());
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
  CHECK(
      begins(with([](MatterScene& s) { s.shape = SoftShape::ball, s.model = "a.ply"; }), "shape: cannot be combined"));
}

}  // namespace palpate::soft_world_test
