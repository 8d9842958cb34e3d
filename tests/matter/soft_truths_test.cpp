// A soft body in its box, with hands, on each back end.
#include <array>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <random>

#include "tests/labels.hpp"
#include "tests/matter/on_matter.hpp"

namespace palpate::soft_truths_test {

namespace {

constexpr double kSpacing_m = 0.005, kYoung_Pa = 5e4;

// Momentum that is not accounted for, relative to all that was given.
double missingShare(const MatterSimulation& world, const DVec3& before) {
  const MatterImpulses& given = world.impulses();
  const DVec3 missing = world.totals().momentum - (before + given.gravity - given.onWalls - given.onTools);
  return glm::length(missing) / (glm::length(before) + glm::length(given.gravity) + glm::length(given.onTools));
}

// Relaxes to rest, critically damped for the slowest motion, given by its angular frequency.
void relax(MatterSimulation& world, double slowest_rad_s) {
  const double perStep = slowest_rad_s * kMatterStep_s;
  const auto kept = static_cast<float>(std::exp(-2 * perStep));
  for (int k = 0; k < 10 / perStep; ++k) {
    world.step();
    std::vector<Vec3> velocities = world.velocitiesById();
    for (Vec3& velocity : velocities) velocity *= kept;
    world.setVelocities(velocities);
  }
  REQUIRE(world.state() == MatterState::running);
}

// The nodes farthest along x, and their mean displacement from `rest`.
std::vector<std::size_t> endOf(const std::vector<Vec3>& rest) {
  float far = 0;
  for (const Vec3& place : rest) far = std::max(far, place.x);
  std::vector<std::size_t> end;
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (rest[i].x > far - 1e-6f) end.push_back(i);
  return end;
}

DVec3 meanMove(const MatterSimulation& world, const std::vector<Vec3>& rest) {
  const std::vector<Vec3> now = world.positionsById();
  const std::vector<std::size_t> end = endOf(rest);
  DVec3 sum(0);
  for (const std::size_t i : end) sum += DVec3(now[i]) - DVec3(rest[i]);
  return sum / static_cast<double>(end.size());
}

// Sized in spacings of 5 mm, far from all walls, held at its low end along x, without gravity.
MatterScene softBar(const DVec3& spacings) {
  // It stands in the centre of its box on the floor, which acts only on what penetrates it.
  const DVec3 fill_mm = spacings * kSpacing_m * 1e3;
  return {.matter = Matter::soft,
          .box_mm = {2 * fill_mm.x, 1000, 1000},
          .fill_mm = fill_mm,
          .spacing_mm = kSpacing_m * 1e3,
          .viscosity_Pa_s = 0,
          .young_Pa = kYoung_Pa,
          .poisson = 0,
          .pinned_mm = std::array{DVec3(0), DVec3(fill_mm.x / 2 + 0.01, 1000, 1000)},
          .gravity_m_s2 = DVec3(0)};
}

// A ball in a hand, pressed into a block by a tenth of its radius.
struct HertzCase {
  int width, height;  ///< of the block, cells
  int ball;           ///< radius, spacings
  double poisson;
  double within;
};

}  // namespace

TEST_CASE_FIXTURE(OnSoft, "a bar is extended by its own weight by rho g L^2 / 2 E") {
  const DVec3 spacings = onCpuOrGpu(DVec3(16, 3, 3), DVec3(10, 2, 2));
  constexpr double poisson = 0.3;
  MatterScene scene = softBar(spacings);
  scene.poisson = poisson;
  const double length = spacings.x * kSpacing_m, strain = 0.004;
  // Gravity acts along x only.
  scene.gravity_m_s2 = {2 * strain * kYoung_Pa / (1000 * length), 0, 0};
  const auto world = make(scene, 0, nullptr, {});
  const std::vector<Vec3> rest = world->positionsById();
  relax(*world, 1.571 * std::sqrt(kYoung_Pa / 1000) / length);
  checkTruth(fmt::format("E A / L of a bar under its weight, Poisson's ratio {:g}, way of its end, mm", poisson),
             1e3 * meanMove(*world, rest).x, 1e3 * strain * length, 0.02);
}

TEST_CASE_FIXTURE(OnSoft, "a beam is bent by its own weight by w L^4 / 8 E I and shear (Timoshenko)") {
  const DVec3 spacings = onCpuOrGpu(DVec3(12, 2, 2), DVec3(8, 1, 1));
  MatterScene scene = softBar(spacings);
  const double length = spacings.x * kSpacing_m, height = spacings.y * kSpacing_m, width = spacings.z * kSpacing_m;
  const double inertia = width * std::pow(height, 3) / 12, area = width * height;
  const double shear = kYoung_Pa / 2, factor = 10.0 / 12;  // Cowper 1966, for a Poisson's ratio of 0
  const double perLoad =
      std::pow(length, 4) / (8 * kYoung_Pa * inertia) + length * length / (2 * factor * shear * area);
  // Upwards, away from the floor.
  const double load_N_m = 0.02 * length / perLoad;
  scene.gravity_m_s2 = {0, load_N_m / (1000 * area), 0};
  const auto world = make(scene, 0, nullptr, {});
  const std::vector<Vec3> rest = world->positionsById();
  relax(*world, 3.516 * std::sqrt(kYoung_Pa / 12000) * height / (length * length));
  checkTruth(fmt::format("beam under its weight, {:g} cells high, way of its end, mm", spacings.y),
             1e3 * meanMove(*world, rest).y, 1e3 * load_N_m * perLoad, 0.04);
}

TEST_CASE_FIXTURE(OnSoft, "a bar vibrates along itself at the frequency of its wave") {
  const DVec3 spacings = onCpuOrGpu(DVec3(16, 2, 2), DVec3(10, 1, 1));
  const int rounds = onCpuOrGpu(3, 2);
  const double length = spacings.x * kSpacing_m;
  const auto world = make(softBar(spacings), 0, nullptr, {});
  const std::vector<Vec3> rest = world->positionsById();
  const std::size_t end = endOf(rest).front();
  std::vector<Vec3> velocities;
  for (const Vec3& place : rest) {
    const double along = static_cast<double>(place.x) / length - 0.5;  // the body is in the centre of its box
    velocities.emplace_back(0.01 * std::sin(1.5708 * along), 0, 0);
  }
  world->setVelocities(velocities);
  // Times at which the end passes its rest position upwards, interpolated between two steps.
  double before = 0, first = 0, last = 0;
  int done = -1;
  for (int k = 1; done < rounds; ++k) {
    REQUIRE(k < 100000);
    world->step();
    const double now = static_cast<double>(world->positionsById()[end].x) - static_cast<double>(rest[end].x);
    if (before < 0 && now >= 0) {
      last = kMatterStep_s * (k - now / (now - before));
      if (++done == 0) first = last;
    }
    before = now;
  }
  checkTruth("frequency of a bar along itself, Hz", done / (last - first), std::sqrt(kYoung_Pa / 1000) / (4 * length),
             0.01);
}

TEST_CASE_FIXTURE(OnSoft, "a ball pressed by a hand pushes back as Hertz predicts" * kMoreInFull * kFullOnGpu) {
  const HertzCase small{.width = 16, .height = 12, .ball = 5, .poisson = 0.45, .within = 0.09},
      large{.width = 32, .height = 24, .ball = 8, .poisson = 0.3, .within = 0.08};
  for (const HertzCase& one : onCpuOrGpu(byTier<std::vector<HertzCase>>({small}, {small, large}), {small})) {
    const double ball_m = one.ball * kSpacing_m, height_m = one.height * kSpacing_m, width_m = one.width * kSpacing_m;
    MatterScene scene{.matter = Matter::soft,
                      .box_mm = 1e3 * DVec3(width_m + 0.04, height_m + 3 * ball_m, width_m + 0.04),
                      .fill_mm = 1e3 * DVec3(width_m, height_m, width_m),
                      .spacing_mm = 1e3 * kSpacing_m,
                      .viscosity_Pa_s = 0,
                      .young_Pa = kYoung_Pa,
                      .poisson = one.poisson,
                      .pinned_mm = std::array{DVec3(0), DVec3(1e3, 0.001, 1e3)},
                      .gravity_m_s2 = DVec3(0),
                      .tool = {.radius_mm = 1e3 * ball_m, .mass_kg = 0.5}};
    const auto world = make(scene, 1, nullptr, {});
    const double shear_Pa = kYoung_Pa / (2 * (1 + one.poisson));
    const double perStep = 1.571 * std::sqrt(shear_Pa / 1000) / height_m * kMatterStep_s;
    const auto kept = static_cast<float>(std::exp(-2 * perStep));
    const double middle_m = scene.box_mm.x * 1e-3 / 2, above_m = height_m + ball_m;
    HandPose hand{.place_m = {middle_m, above_m, middle_m}};
    for (int k = 0; k < 8 / perStep; ++k) {
      hand.place_m.y = above_m - 0.1 * ball_m * std::min(1.0, perStep * k);
      world->step({&hand, 1});
      std::vector<Vec3> velocities = world->velocitiesById();
      for (Vec3& velocity : velocities) velocity *= kept;
      world->setVelocities(velocities);
    }
    REQUIRE(world->state() == MatterState::running);
    // The spring that holds the ball yields, too.
    const double deep_m = above_m - world->answers()[0].place_m.y;
    CHECK(deep_m > 0.07 * ball_m);
    const double stiffness = 4.0 / 3 * kYoung_Pa / (1 - one.poisson * one.poisson) * std::sqrt(ball_m);
    checkTruth(fmt::format("Hertz, ball of {} spacings, Poisson's ratio {:g}, d = {:.2f} R, N", one.ball, one.poisson,
                           deep_m / ball_m),
               world->answers()[0].reaction_N.y, stiffness * std::pow(deep_m, 1.5), one.within);
  }
}

TEST_CASE_FIXTURE(OnSoft, "a rotation causes no stress") {
  MatterScene scene = softBlock();
  scene.box_mm = {1000, 1000, 1000};
  scene.fill_mm = {30, 25, 20};
  scene.viscosity_Pa_s = 20;
  scene.gravity_m_s2 = DVec3(0);
  const DVec3 axis = glm::normalize(DVec3(1, -2, 0.5));
  double most = 0;
  for (const double angle : {0.3, 1.6, 3.1}) {
    const auto world = make(scene, 0, nullptr, {});
    const DQuat turn = glm::angleAxis(angle, axis);
    std::vector<Vec3> displacements;
    for (const Vec3& rest : world->positionsById()) {
      const DVec3 arm = DVec3(rest) - DVec3(0.5, 0.0125, 0.5);
      displacements.emplace_back(turn * arm - arm + DVec3(0, 0.03, 0));  // off the floor
    }
    bend(*world, displacements);
    world->step();
    // In units of the speed that a corner node would get in that time from the stress at a strain of 1.
    const double unit = 3e4 * kSpacing_m * kSpacing_m / (1000 * std::pow(kSpacing_m, 3) / 8) * kMatterStep_s;
    for (const Vec3& velocity : world->velocitiesById()) most = std::max(most, double(glm::length(velocity)) / unit);
  }
  checkAtMost("stress of a body that is turned by up to 3.1 rad, of that of a strain of 1", most, 1e-5);
}

TEST_CASE_FIXTURE(OnSoft,
                  "a falling body bounces, and its momentum balances gravity, walls, pins and tools" * kMoreInFull) {
  const int steps = onCpuOrGpu(500, byTier(30, 120));
  MatterScene scene = softBlock();
  scene.shape = SoftShape::ball;
  scene.viscosity_Pa_s = 0.5;
  const auto world = make(scene, 0, nullptr, {});
  world->setVelocities(std::vector<Vec3>(world->particles(), Vec3(0.6f, -0.8f, 0)));
  const double mass = 4.18879 * std::pow(0.02, 3) * 1000;
  const DVec3 before = mass * DVec3(Vec3(0.6f, -0.8f, 0));
  for (int k = 0; k < steps; ++k) {
    run(*world, 1);
    const MatterImpulses& given = world->impulses();
    // The ball's actual mass, which rounding changes, is measured by its weight.
    const double weighs = glm::length(given.gravity) / (kGravity_m_s2 * kMatterStep_s * (k + 1));
    CHECK(isWithin(0.01, weighs, mass));
    REQUIRE(missingShare(*world, before * (weighs / mass)) <= 1e-5);
  }
  CHECK(world->impulses().onWalls.y < -0.1 * mass);
  MatterScene held = softBlock();
  held.pinned_mm = {DVec3(0, 30, 0), DVec3(100, 45, 100)};
  held.gravity_m_s2 = {2, -9, 3};
  const auto pinned = make(held, 1, nullptr, {});
  const HandPose hand{.place_m = {0.05, 0.045, 0.05}};
  for (int k = 0; k < steps; ++k) {
    pinned->step({&hand, 1});
    REQUIRE(missingShare(*pinned, DVec3(0)) <= 1e-5);
  }
  CHECK(pinned->impulses().onTools.y > 0.001);
  CHECK(std::abs(pinned->impulses().onWalls.y) > 0.001);
}

TEST_CASE_FIXTURE(OnSoft, "a ball receives the momentum that the body loses, and the hand feels it" * kFullOnGpu) {
  const int down = 200, staying = onCpuOrGpu(400, 250);
  const auto world = make(softBlock(), 2, nullptr, {});
  std::array<HandPose, 2> hands{HandPose{.place_m = {0.035, 0.055, 0.05}}, HandPose{.place_m = {0.07, 0.055, 0.05}}};
  DVec3 reactions(0);
  for (int k = 0; k < down + staying; ++k) {
    for (HandPose& hand : hands) hand.place_m.y -= k < down ? 0.008 / down : 0;
    world->step(hands);
    reactions += kMatterStep_s * (world->answers()[0].reaction_N + world->answers()[1].reaction_N);
  }
  REQUIRE(world->state() == MatterState::running);
  const MatterImpulses& given = world->impulses();
  CHECK(given.onTools.y > 0.01);
  CHECK(glm::length(given.onTools - reactions) <= 1e-9 * glm::length(reactions));
  checkAtMost("momentum that nobody gave a soft body with two balls, share", missingShare(*world, DVec3(0)), 1e-5);
  for (const ToolAnswer& answer : world->answers()) {
    CHECK(answer.reaction_N.y > 0.01);
    CHECK(isWithin(0.02, answer.force_N.y, answer.reaction_N.y));
  }
}

TEST_CASE_FIXTURE(OnSoft, "a soft body that is pushed and released returns to its shape" * kFullOnGpu) {
  constexpr int pressed = 150, free = 850;
  MatterScene scene = softBlock();
  scene.gravity_m_s2 = DVec3(0);
  scene.pinned_mm = {DVec3(0), DVec3(100, 0.1, 100)};
  const auto world = make(scene, 1, nullptr, {});
  const std::vector<Vec3> rest = world->positionsById();
  double deepest = 0;
  for (int k = 0; k < pressed + free; ++k) {
    const double down = k < pressed ? 2.4e-2 * std::sin(3.1416 * k / pressed) : 0;
    const HandPose hand{.place_m = DVec3(0.05, 0.06 - down, 0.05)};
    world->step({&hand, 1});
    deepest = std::max(deepest, world->totals().maxCompression);
  }
  REQUIRE(world->state() == MatterState::running);
  CHECK(deepest > 0.05);
  const MatterImpulses& given = world->impulses();
  CHECK(given.onTools.y > 0.01);
  CHECK(glm::length(world->totals().momentum + given.onWalls + given.onTools) <= 1e-5 * glm::length(given.onTools));
  const std::vector<Vec3> now = world->positionsById();
  double away_m = 0;
  for (std::size_t i = 0; i < now.size(); ++i) away_m = std::max(away_m, double(glm::length(now[i] - rest[i])));
  checkAtMost("where nodes are after a press, from where they were, um", 1e6 * away_m, 1);
}

TEST_CASE_FIXTURE(OnSoft, "random hands gain no energy from a soft body" * kMoreInFull * kFullOnGpu) {
  const int hands = onCpuOrGpu(byTier(2, 3), 2), steps = onCpuOrGpu(byTier(350, 1200), 400);
  std::mt19937 random(7);
  std::normal_distribution<double> push;
  double leastOfAll_J = 0;
  for (int each = 0; each < hands; ++each) {
    MatterScene scene = softBlock();
    scene.viscosity_Pa_s = each == 0 ? 0 : 3;
    const auto world = make(scene, 1, nullptr, {});
    HandPose hand{.place_m = {0.05, 0.056, 0.05}};
    DVec3 speed(0);
    double min_J = 0, most_N = 0;
    for (int k = 0; k < steps; ++k) {
      speed = 0.98 * speed - DVec3(0, 4e-3, 0);
      for (int axis = 0; axis < 3; ++axis) speed[axis] += 0.05 * push(random);
      hand.place_m = glm::clamp(hand.place_m + kMatterStep_s * speed, DVec3(0.03, 0.03, 0.03), DVec3(0.07, 0.08, 0.07));
      world->step({&hand, 1});
      min_J = std::min(min_J, world->portEnergy_J(0));
      most_N = std::max(most_N, glm::length(world->answers()[0].reaction_N));
    }
    REQUIRE(world->state() == MatterState::running);
    leastOfAll_J = std::min(leastOfAll_J, min_J);
    CHECK(most_N > 0.3);
  }
  checkAtMost("energy that random hands get out of a soft body by a ball, mJ", 1e3 * std::abs(leastOfAll_J), 1);
}

TEST_CASE_FIXTURE(OnSoft, "a soft body gives the same results bit by bit again, with other threads and after a reset" *
                              kMoreInFull) {
  const int steps = onCpuOrGpu(150, byTier(15, 60));
  const auto a = maker(1)(softBlock(), 1, nullptr, {}), b = maker(3)(softBlock(), 1, nullptr, {});
  const auto press = [&](MatterSimulation& world) {
    HandPose hand{.place_m = {0.05, 0.053, 0.05}};
    for (int k = 0; k < steps; ++k) {
      hand.place_m.y -= 0.0075 / steps;
      world.step({&hand, 1});
    }
    REQUIRE(world.state() == MatterState::running);
    CHECK(world.answers()[0].reaction_N.y > 0.01);
  };
  press(*a);
  press(*b);
  CHECK(sameBytes(*a, *b));
  CHECK(a->answers()[0].force_N == b->answers()[0].force_N);
  CHECK(a->observe().momentum == b->observe().momentum);
  CloudFrame x, y;
  a->makeFrame(x);
  b->makeFrame(y);
  CHECK(x.positions == y.positions);
  CHECK(x.normals == y.normals);
  CHECK(x.velocities == y.velocities);
  a->reset();
  press(*a);
  CHECK(sameBytes(*a, *b));
}

TEST_CASE_FIXTURE(OnSoft, "a diverging soft body reports it, has no force from then on, and can be reset") {
  for (const float velocity : {1e6f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const auto world = make(softBlock(), 1, nullptr, {});
    const HandPose hand{.place_m = {0.05, 0.045, 0.05}};
    for (int k = 0; k < 10; ++k) world->step({&hand, 1});
    CHECK(world->answers()[0].force_N.y > 0);
    world->setVelocities(std::vector<Vec3>(world->particles(), Vec3(velocity, 0, 0)));
    world->step({&hand, 1});
    for (int k = 0; k < 2; ++k, world->step({&hand, 1})) {
      CHECK(world->state() == MatterState::diverged);
      CHECK(world->answers()[0].force_N == DVec3(0));
      CHECK(world->answers()[0].reaction_N == DVec3(0));
    }
    world->reset();
    CHECK(world->state() == MatterState::running);
    const auto fresh = make(softBlock(), 1, nullptr, {});
    for (int k = 0; k < 5; ++k) {
      world->step({&hand, 1});
      fresh->step({&hand, 1});
    }
    CHECK(sameBytes(*world, *fresh));
  }
}

TEST_CASE_FIXTURE(
    OnSoft, "a hand that jumps across the box of a soft body gets a bounded, finite force or ends the simulation") {
  const int steps = onCpuOrGpu(200, 60);
  const auto world = make(softBlock(), 1, nullptr, {});
  for (int k = 0; k < steps; ++k) {
    const HandPose hand{.place_m = {0.05, k % 20 == 10 ? 1e3 : 0.05, 0.05}};
    world->step({&hand, 1});
    REQUIRE(isFinite(world->answers()[0].force_N));
    REQUIRE(isFinite(world->answers()[0].reaction_N));
  }
}

TEST_CASE_FIXTURE(OnSoft, "pinned nodes stay at rest") {
  const int steps = onCpuOrGpu(20, 10);
  MatterScene scene = softBlock();
  scene.pinned_mm = {DVec3(0), DVec3(51, 100, 100)};
  const auto world = make(scene, 0, nullptr, {});
  const std::vector<Vec3> rest = world->positionsById();
  world->setVelocities(std::vector<Vec3>(rest.size(), Vec3(0, 0, 0.2f)));
  run(*world, steps);
  const std::vector<Vec3> now = world->positionsById(), velocities = world->velocitiesById();
  int held = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const bool isPinned = rest[i].x < 0.051f;
    held += isPinned ? 1 : 0;
    REQUIRE((now[i] == rest[i]) == isPinned);
    REQUIRE((velocities[i] == Vec3(0)) == isPinned);
  }
  CHECK(held == 6 * 9 * 11);
}

}  // namespace palpate::soft_truths_test
