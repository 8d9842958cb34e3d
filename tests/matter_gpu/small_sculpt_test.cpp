// Soft bodies sculpted during a simulation on a GPU.
#include "engine/matter/soft_scene.hpp"
#include "engine/matter/soft_sculpture.hpp"
#include "engine/matter/soft_world.hpp"
#include "tests/history_steps.hpp"
#include "tests/labels.hpp"
#include "tests/matter/pressing_hand.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"
#include "tests/matter_gpu/gpu_soft.hpp"

namespace palpate::small_sculpt_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

// A body on its floor, without a tool's ball.
MatterScene lump() {
  return {.matter = Matter::soft,
          .box_mm = {80, 80, 80},
          .fill_mm = {45, 30, 35},
          .spacing_mm = 5,
          .viscosity_Pa_s = 3,
          .young_Pa = 3e4};
}

DVec3 topOf(const MatterScene& scene) { return 1e-3 * DVec3(scene.box_mm.x / 2, scene.fill_mm.y, scene.box_mm.z / 2); }

// Moves all surface positions within 9 mm of `middle` by `way`, once. Returns the number of moved nodes.
std::size_t push(MatterSimulation& world, const DVec3& middle, const DVec3& way) {
  world.beginSculpting();
  SoftSculpture& sculpture = *world.sculpture();
  std::vector<PlaceWay> ways;
  for (std::uint32_t i = 0; i < sculpture.surface().size(); ++i)
    if (glm::distance(DVec3(sculpture.surface().placeOf(sculpture.body(), i)), middle) < 0.009)
      ways.push_back({.place = i, .way = way});
  const std::size_t moved = sculpture.yield(ways);
  world.endSculpting();
  return moved;
}

void checkAlikeWithin(const MatterSimulation& gpu, const MatterSimulation& cpu, double places_m) {
  checkAlike(gpu, cpu,
             {.places_m = places_m,
              .kinetic = 2e-3,
              .compression = 1e-4,
              .leastForce_N = 0.001,
              .arm_m = 0.01,
              .energyShare = 0,
              .energy_J = 1e-7});
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture,
                  "a sculpted body moves on the GPU as on the CPU, during strokes, after undo and after a reset") {
  const MatterScene scene = lump();
  GpuSoftWorld gpu(device, device.latencyQueue(), scene);
  SoftWorld cpu(scene, {.threads = 2});
  const auto both = [&](auto does) {
    does(static_cast<MatterSimulation&>(gpu));
    does(static_cast<MatterSimulation&>(cpu));
  };
  both([](MatterSimulation& world) { run(world, 3); });
  for (int k = 0; k < 8; ++k) {
    both([&](MatterSimulation& world) {
      CHECK(push(world, topOf(scene) - DVec3(0, 3e-4 * k, 0), {0, -3e-4, 5e-5}) > 20);
      world.step();
    });
    checkAlikeWithin(gpu, cpu, 2e-6);
  }
  CHECK(cpu.body().rest().stiffest() > 1.05);
  both([](MatterSimulation& world) {
    world.sculpture()->endStroke();
    run(world, 4);
  });
  checkAlikeWithin(gpu, cpu, 2e-6);
  const auto shapeOf = [](MatterSimulation& world) {
    const std::span<const Vec3> rest = world.sculpture()->body().rest().displacements();
    return std::vector<Vec3>(rest.begin(), rest.end());
  };
  const std::vector<Vec3> shape = shapeOf(gpu);
  ShapeHistory ofGpu(*gpu.sculpture()), ofCpu(*cpu.sculpture());
  const auto strokesOf = [&](const MatterSimulation& world) -> auto& { return &world == &gpu ? ofGpu : ofCpu; };
  MatterScene softer = scene;
  softer.young_Pa = 2e4;
  both([&](MatterSimulation& world) {
    world.change(softer);
    run(world, 3);
  });
  checkAlikeWithin(gpu, cpu, 2e-6);
  both([&](MatterSimulation& world) {
    world.beginSculpting();
    CHECK(strokesOf(world).undo());
    world.endSculpting();
    run(world, 2);
  });
  CHECK(shapeOf(gpu) == std::vector<Vec3>(shape.size(), Vec3(0)));
  checkAlikeWithin(gpu, cpu, 2e-6);
  both([&](MatterSimulation& world) {
    world.beginSculpting();
    CHECK(strokesOf(world).redo());
    world.endSculpting();
    world.reset();
    CHECK(world.particles() > 0);
  });
  CHECK(shapeOf(gpu) == shape);
  CHECK(gpu.displacements() == shape);
  both([](MatterSimulation& world) { run(world, 3); });
  checkAlikeWithin(gpu, cpu, 2e-6);
}

TEST_CASE_FIXTURE(GpuFixture,
                  "on the GPU a sculpted shape is free of stress, and nodes out of the brush's reach stay bit by bit") {
  MatterScene scene = lump();
  scene.gravity_m_s2 = DVec3(0);
  GpuSoftWorld world(device, device.latencyQueue(), scene);
  std::vector<Vec3> motion(world.nodes());
  for (std::size_t i = 0; i < motion.size(); ++i) motion[i] = {0, 1e-4f * static_cast<float>(i % 7), 0};
  world.setDisplacements(motion);
  const std::vector<Vec3> rest = world.positionsById();
  // Sculpting without a change moves nothing.
  world.beginSculpting();
  world.endSculpting();
  CHECK(world.displacements() == motion);
  for (int k = 0; k < 3; ++k) push(world, topOf(scene), {0, -4e-4, 0});
  const std::vector<Vec3> moved = world.displacements();
  std::size_t changed = 0;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const double away = glm::distance(DVec3(rest[i]), topOf(scene));
    if (away > 0.009 + 0.0012 + SoftSculpture::kReach_spacings * 0.005 + 1e-3) REQUIRE(moved[i] == motion[i]);
    changed += moved[i] != motion[i] ? 1 : 0;
  }
  CHECK(changed > 20);
  world.setDisplacements(std::vector<Vec3>(world.sculpture()->body().rest().displacements().begin(),
                                           world.sculpture()->body().rest().displacements().end()));
  world.setVelocities(std::vector<Vec3>(world.nodes(), Vec3(0)));
  world.step();
  // In units of the speed that the stress of a strain of 1 would give a corner node in this time.
  const double unit = 3e4 * 0.005 * 0.005 / (1000 * std::pow(0.005, 3) / 8) * kMatterStep_s;
  for (const Vec3& velocity : world.velocitiesById()) REQUIRE(double(glm::length(velocity)) <= 2e-5 * unit);
}

TEST_CASE_FIXTURE(GpuFixture, "on the GPU a dented body gets more substeps and yields to presses as on the CPU") {
  MatterScene scene = lump();
  scene.tool = {};
  GpuSoftWorld gpu(device, device.latencyQueue(), scene);
  SoftWorld cpu(scene, {.threads = 2});
  std::vector<PressingHand> hands(2, PressingHand(topOf(scene) - DVec3(0, 4e-3, 0), 0.008));
  for (int k = 0; k < 40; ++k) {
    push(gpu, topOf(scene) - DVec3(0, 2.5e-4 * k, 0), {0, -5e-4, 0});
    push(cpu, topOf(scene) - DVec3(0, 2.5e-4 * k, 0), {0, -5e-4, 0});
  }
  CHECK(gpu.sculpture()->body().rest().stiffest() > 1.3);
  CHECK(substepsOf(scene, gpu.plan(), gpu.sculpture()->body().rest().stiffest()) > gpu.plan().substeps);
  for (int k = 0; k < 5; ++k) {
    const SurfacePress press = hands[0].goTo(hands[0].press().handTo_m - DVec3(0, 2e-4, 0));
    for (MatterSimulation* world : {static_cast<MatterSimulation*>(&gpu), static_cast<MatterSimulation*>(&cpu)}) {
      world->press({&press, 1});
      world->step();
    }
    hands[0].heard(cpu.pressed()[0]);
  }
  CHECK(cpu.pressed()[0].force_N.y > 0.01);
  CHECK(isWithin(2e-3, gpu.pressed()[0].force_N.y, cpu.pressed()[0].force_N.y));
  checkAlikeWithin(gpu, cpu, 2e-6);
  const DVec3 there = cpu.pressed()[0].place_m;
  CHECK(isWithin(0.01, gpu.localCompliance_m_N(there, 0.008, {0, -1, 0}),
                 cpu.localCompliance_m_N(there, 0.008, {0, -1, 0})));
}

TEST_CASE_FIXTURE(GpuFixture, "on the GPU a body that is touched by balls cannot be sculpted") {
  MatterScene scene = lump();
  scene.tool = {.radius_mm = 8, .mass_kg = 0.01};
  CHECK(GpuSoftWorld(device, device.latencyQueue(), scene, {.tools = 1}).sculpture() == nullptr);
}

TEST_SUITE_END();

}  // namespace palpate::small_sculpt_test
