// A few hundred particles on the GPU against the same particles on the CPU.
#include <array>
#include <random>

#include "engine/core/named_values.hpp"
#include "tests/labels.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"

namespace palpate::small_matter_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

// Random positions with a minimum distance, so that both simulations stay together for a while.
std::vector<Vec3> scattered(std::size_t count, const DVec3& box_mm, double apart_mm) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<Vec3> places;
  while (places.size() < count) {
    Vec3 place;
    for (int k = 0; k < 3; ++k) place[k] = static_cast<float>(share(random) * box_mm[k] * 1e-3);
    const auto isNear = [&](const Vec3& other) { return glm::length(place - other) < 1e-3 * apart_mm; };
    if (std::ranges::none_of(places, isNear)) places.push_back(place);
  }
  return places;
}

// Position of a tool's hand after some steps: two side by side, and the third close to the first.
DVec3 handPlace(std::size_t tool, int step) {
  return {0.03 + 0.04 * static_cast<double>(tool % 2) + 0.003 * static_cast<double>(tool / 2), 0.05 - 2e-4 * step,
          0.035};
}

// Moves particles that are inside a ball at the start, where the ball would have to grow.
std::vector<Vec3> awayFromHands(std::vector<Vec3> places, std::size_t tools, const MatterScene& scene) {
  const double within_m = (scene.tool.radius_mm + 0.26 * scene.spacing_mm) * 1e-3;
  for (Vec3& place : places)
    for (std::size_t tool = 0; tool < tools; ++tool)
      if (glm::length(DVec3(place) - handPlace(tool, 0)) < within_m) place.y = 0.09f;
  return places;
}

// The same scene on both, for a few steps, with hands that descend and rotate.
struct Both {
  std::unique_ptr<MatterSimulation> gpu, cpu;

  Both(Device& device, const MatterScene& scene, std::size_t tools, const std::vector<Vec3>& places)
      : gpu(onGpu(device)(scene, tools, places)), cpu(onCpu()(scene, tools, places)) {}

  void step(int steps) {
    for (int k = 0; k < steps; ++k, ++step_) {
      std::vector<HandPose> hands;
      for (std::size_t tool = 0; tool < gpu->answers().size(); ++tool) {
        const double angle = 0.02 * step_ * (static_cast<double>(tool) + 1);
        hands.push_back({.place_m = handPlace(tool, step_),
                         .orientation = {std::cos(angle), 0.6 * std::sin(angle), 0, 0.8 * std::sin(angle)}});
      }
      gpu->step(hands);
      cpu->step(hands);
      for (const ToolAnswer& answer : gpu->answers()) reactions_ += kMatterStep_s * answer.reaction_N;
    }
  }

  void checkAlike() const {
    palpate::checkAlike(*gpu, *cpu,
                        {.places_m = 1.5e-6,  // measured: 1.06 um on an H200
                         .kinetic = 1e-3,
                         .compression = 1e-4,
                         .leastForce_N = 0.01,
                         .arm_m = 0.02,
                         .energyShare = 1e-3,
                         .energy_J = 1e-9});
  }

  /// The balls received the momentum that the matter lost, which was at rest.
  void checkReactions() const {
    CHECK(glm::length(gpu->impulses().onTools - reactions_) <= 1e-9 * glm::length(reactions_));
    CHECK(missingMomentum(*gpu) <= 1e-5);
  }

 private:
  int step_ = 0;
  DVec3 reactions_{0};
};

MatterScene smallScene(Matter matter) {
  return {.matter = matter,
          .box_mm = {93, 101, 77},
          .fill_mm = {50, 50, 50},
          .spacing_mm = 10,
          .gravity_m_s2 = {3, -7, 5},
          .tool = {.radius_mm = 15, .mass_kg = 0.03},
          .gain = 3};
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "any number of particles, and their forces on a tool, agree between GPU and CPU") {
  for (const Matter matter : {Matter::water, Matter::sand})
    for (const std::size_t count : {0, 1, 2, 255, 256, 257}) {
      CAPTURE(nameOf(kMatters, matter));
      CAPTURE(count);
      const MatterScene scene = smallScene(matter);
      Both both(device, scene, 1, awayFromHands(scattered(count, scene.box_mm, 7), 1, scene));
      both.step(3);
      both.checkAlike();
      both.step(5);
      both.checkAlike();
    }
}

TEST_CASE_FIXTURE(GpuFixture, "particles cross periodic borders and interact across them on the GPU as on the CPU") {
  const std::array<std::array<bool, 3>, 4> boxes{
      {{true, false, false}, {false, true, true}, {true, false, true}, {true, true, true}}};
  for (const Matter matter : {Matter::water, Matter::sand})
    for (const auto& periodic : boxes) {
      CAPTURE(nameOf(kMatters, matter));
      MatterScene scene = smallScene(matter);
      scene.periodic = periodic;
      Both both(device, scene, 0, scattered(300, scene.box_mm, 7));
      const std::vector<Vec3> velocities(300, Vec3(2, -2.5, 3));
      both.gpu->setVelocities(velocities);
      both.cpu->setVelocities(velocities);
      both.step(6);
      both.checkAlike();
    }
}

TEST_CASE_FIXTURE(GpuFixture,
                  "several tools get the same forces on the GPU as on the CPU, even if they share particles") {
  for (const Matter matter : {Matter::water, Matter::sand})
    for (const std::size_t tools : {2, 3}) {
      CAPTURE(nameOf(kMatters, matter));
      MatterScene scene = smallScene(matter);
      scene.box_mm.x = 143;
      scene.fill_mm = {140, 50, 70};
      Both both(device, scene, tools, awayFromHands(placesAtRest(scene), tools, scene));
      both.step(12);
      both.checkAlike();
      both.checkReactions();
      for (const ToolAnswer& answer : both.cpu->answers()) CHECK(glm::length(answer.reaction_N) > 1e-5);
    }
}

TEST_CASE_FIXTURE(GpuFixture, "particles around a model and in a ball agree between GPU and CPU") {
  for (const Matter matter : {Matter::water, Matter::sand}) {
    CAPTURE(nameOf(kMatters, matter));
    MatterScene scene = smallScene(matter);
    scene.model = "builtin:sphere";
    scene.model_mm = DVec3(40);
    if (matter == Matter::water) scene.cohesion_N_m = 0.0728;
    Both both(device, scene, 1, placesAtRest(scene));
    REQUIRE(both.gpu->leftOut() == both.cpu->leftOut());
    REQUIRE(both.gpu->leftOut() > 10);
    both.step(2);
    both.checkAlike();
    CHECK(both.cpu->pushedOut(0) > 5);
    CHECK(both.gpu->pushedOut(0) == both.cpu->pushedOut(0));
    CHECK(glm::length(both.cpu->impulses().onModel) > 1e-7);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "a ball stops at a model and slides on it, on the GPU as on the CPU") {
  constexpr double kSphere_m = 0.03, kBall_m = 0.015;
  const MatterScene scene{.box_mm = {120, 150, 120},
                          .fill_mm = {0, 0, 0},
                          .spacing_mm = 10,
                          .model = "builtin:sphere",
                          .model_mm = {60, 60, 60},
                          .tool = {.radius_mm = 1e3 * kBall_m, .mass_kg = 0.05}};
  const auto gpu = onGpu(device)(scene, 1, {}), cpu = onCpu()(scene, 1, {});
  const DVec3 middle(0.06, kSphere_m, 0.06), way = glm::normalize(DVec3(1, -2, 0.5));
  HandPose hand{.place_m = middle - (kSphere_m + kBall_m + 0.003) * way};
  double most_N = 0;
  for (int k = 0; k < 30; ++k) {
    hand.place_m += k < 13 ? 8e-4 * way : 5e-4 * glm::normalize(glm::cross(way, DVec3(0, 0, 1)));
    gpu->step({&hand, 1});
    cpu->step({&hand, 1});
    const ToolAnswer &is = gpu->answers()[0], &expected = cpu->answers()[0];
    const double force_N = glm::length(expected.byModel_N);
    most_N = std::max(most_N, force_N);
    REQUIRE((glm::length(is.byModel_N) > 0) == (force_N > 0));
    REQUIRE(glm::distance(is.byModel_N, expected.byModel_N) <= 2e-3 * force_N + 1e-3);
    REQUIRE(glm::distance(is.force_N, expected.force_N) <= 2e-3 * glm::length(expected.force_N) + 1e-3);
    REQUIRE(glm::distance(is.place_m, expected.place_m) < 1e-6);
    REQUIRE(glm::distance(is.place_m, middle) > 0.96 * (kSphere_m + kBall_m));
  }
  CHECK(most_N > 1);
}

TEST_CASE_FIXTURE(GpuFixture, "too many neighbours for a list give a state without motion or force, until a reset") {
  for (const std::size_t count : {129, 130}) {
    CAPTURE(count);
    const MatterScene scene = smallScene(Matter::water);
    const auto world = onGpu(device)(scene, 1, std::vector<Vec3>(count, Vec3(0.05f)));
    const HandPose hand{.place_m = {0.05, 0.06, 0.05}};
    world->step({&hand, 1});
    REQUIRE((world->state() == MatterState::crowded) == (count > 129));
    if (count == 129) continue;
    const std::vector<Vec3> before = world->positionsById();
    for (int k = 0; k < 3; ++k) {
      world->step({&hand, 1});
      CHECK(world->state() == MatterState::crowded);
      CHECK(world->answers()[0].force_N == DVec3(0));
      CHECK(world->answers()[0].reaction_N == DVec3(0));
      CHECK(world->positionsById() == before);
    }
    world->reset();
    CHECK(world->state() == MatterState::running);
  }
}

TEST_SUITE_END();

}  // namespace palpate::small_matter_test
