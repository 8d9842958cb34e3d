// Soft bodies of a few cells on the GPU against the same bodies on the CPU, and the points that they carry.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numeric>
#include <random>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/matter/soft_model.hpp"
#include "engine/matter/soft_scan.hpp"
#include "engine/matter/soft_scene.hpp"
#include "engine/matter/soft_world.hpp"
#include "tests/labels.hpp"
#include "tests/matter_gpu/gpu_matter.hpp"
#include "tests/matter_gpu/gpu_soft.hpp"

namespace palpate::small_soft_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

// In a tight box, except for the room of the ball, so that the body touches walls.
MatterScene snug(const DVec3& cells) {
  MatterScene scene{.matter = Matter::soft,
                    .box_mm = glm::max(cells * 5.0 + DVec3(0.4, 14, 0.4), DVec3(18)),
                    .fill_mm = cells * 5.0,
                    .spacing_mm = 5,
                    .viscosity_Pa_s = 3,
                    .young_Pa = 2e4,
                    .gravity_m_s2 = {3, -7, 5},
                    .tool = {.radius_mm = 8, .mass_kg = 0.01},
                    .gain = 3};
  return scene;
}

struct BothSoft {
  std::unique_ptr<MatterSimulation> gpu, cpu;

  BothSoft(Device& device, const MatterScene& scene, std::size_t tools, const SoftSolid* solid = nullptr,
           std::span<const SurfacePlace> points = {})
      : gpu(softOnGpu(device)(scene, tools, solid, points)), cpu(softOnCpu()(scene, tools, solid, points)) {
    // Each node gets a random velocity.
    std::mt19937 random(3);
    std::normal_distribution<float> speed(0, 0.2f);
    std::vector<Vec3> velocities(cpu->particles());
    for (Vec3& velocity : velocities) velocity = {speed(random), speed(random), speed(random)};
    gpu->setVelocities(velocities);
    cpu->setVelocities(velocities);
  }

  void step(int steps) {
    const DVec3 box = gpu->scene().box_mm * 1e-3, fill = gpu->scene().fill_mm * 1e-3;
    for (int k = 0; k < steps; ++k, ++step_) {
      std::vector<HandPose> hands;
      for (std::size_t tool = 0; tool < gpu->answers().size(); ++tool) {
        const double angle = 0.02 * step_ * (static_cast<double>(tool) + 1);
        const double along = tool == 0 ? 0.3 : 0.7;
        hands.push_back({.place_m = {along * box.x, fill.y + 0.0073 - 1e-4 * step_, box.z / 2 + 0.001},
                         .orientation = {std::cos(angle), 0.6 * std::sin(angle), 0, 0.8 * std::sin(angle)}});
      }
      gpu->step(hands);
      cpu->step(hands);
      for (const ToolAnswer& answer : gpu->answers()) reactions_ += kMatterStep_s * answer.reaction_N;
    }
  }

  void checkAlike() const {
    palpate::checkAlike(*gpu, *cpu,
                        {.places_m = 1e-6,
                         .kinetic = 1e-4,
                         .compression = 1e-5,
                         .leastForce_N = 0.001,
                         .arm_m = 0.01,
                         .energyShare = 0,
                         .energy_J = 1e-7});
    for (std::size_t tool = 0; tool < gpu->answers().size(); ++tool)
      CHECK(glm::length(gpu->answers()[tool].velocity_m_s - cpu->answers()[tool].velocity_m_s) < 1e-4);
    const MatterObservation seen = gpu->observe(), there = cpu->observe();
    CHECK(isWithin(1e-4, seen.potential_J, there.potential_J));
    CHECK(isWithin(1e-4, seen.front_m, there.front_m));
    CHECK(glm::length(gpu->impulses().onTools - reactions_) <= 1e-9 * glm::length(reactions_));
    checkFrames();
  }

  void checkFrames() const {
    CloudFrame is, expected;
    gpu->makeFrame(is);
    cpu->makeFrame(expected);
    REQUIRE(is.size() == expected.size());
    REQUIRE(is.normals.size() == is.size());
    REQUIRE(is.velocities.size() == is.size());
    CHECK(is.time_s == expected.time_s);
    for (std::size_t i = 0; i < is.size(); ++i) {
      REQUIRE(glm::length(is.positions[i] - expected.positions[i]) < 1e-6f);
      REQUIRE(glm::length(is.normals[i] - expected.normals[i]) < 1e-4f);
      REQUIRE(glm::length(is.velocities[i] - expected.velocities[i]) < 1e-3f);
    }
  }

 private:
  int step_ = 0;
  DVec3 reactions_{0};
};

SoftSolid torus(const MatterScene& scene, std::vector<SurfacePlace>& points) {
  points = placeScan(sampleShape(*makeShape("torus"), {.count = 3000}), scene);
  WorkerTeam team(2);
  return scanSolid(points, scene.spacing_mm * 1e-3, 0, team);
}

MatterScene scanScene() {
  MatterScene scene = snug({24, 8, 24});
  scene.box_mm = {125, 80, 125};
  scene.spacing_mm = 7;
  scene.tool = {.radius_mm = 15, .mass_kg = 0.05};
  return scene;
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "soft bodies of any size, and their forces on tools, agree between GPU and CPU") {
  struct Case {
    DVec3 cells;
    std::size_t tools;
  };
  for (const Case& one : {Case{{1, 1, 1}, 0}, Case{{1, 1, 1}, 1}, Case{{2, 1, 1}, 1}, Case{{17, 4, 3}, 2}}) {
    CAPTURE(one.cells.x);
    CAPTURE(one.tools);
    BothSoft both(device, snug(one.cells), one.tools);
    both.step(2);
    both.checkAlike();
    both.step(4);
    both.checkAlike();
    for (const ToolAnswer& answer : both.cpu->answers()) CHECK(glm::length(answer.reaction_N) > 1e-3);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "a block with inner cells, a ball and a pinned body agree between GPU and CPU") {
  MatterScene block = snug({9, 8, 7});
  BothSoft both(device, block, 1);
  both.step(4);
  both.checkAlike();
  MatterScene ball = snug({8, 8, 8});
  ball.shape = SoftShape::ball;
  BothSoft round(device, ball, 1);
  round.step(4);
  round.checkAlike();
  block.pinned_mm = {DVec3(0), DVec3(20, 60, 30)};
  BothSoft held(device, block, 2);
  held.step(4);
  held.checkAlike();
  CHECK(glm::length(held.cpu->impulses().onWalls) > 1e-4);
}

TEST_CASE_FIXTURE(GpuFixture, "a scan bends on the GPU as on the CPU and carries its points along") {
  const MatterScene scene = scanScene();
  std::vector<SurfacePlace> points;
  const SoftSolid solid = torus(scene, points);
  BothSoft both(device, scene, 1, &solid, points);
  both.checkFrames();
  both.step(4);
  both.checkAlike();
  CHECK(both.gpu->particles() == solid.lattice.nodes());
}

TEST_CASE_FIXTURE(GpuFixture,
                  "on the GPU points at rest keep their positions bit by bit, and follow a uniform strain exactly") {
  const MatterScene scene = scanScene();
  std::vector<SurfacePlace> points;
  const SoftSolid solid = torus(scene, points);
  GpuSoftWorld world(device, device.latencyQueue(), scene, {}, solid, points);
  CloudFrame frame;
  world.makeFrame(frame);
  REQUIRE(frame.size() == points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    REQUIRE(frame.positions[i] == points[i].rest);
    REQUIRE(frame.normals[i] == points[i].normal);
    REQUIRE(frame.velocities[i] == Vec3(0));
  }
  const glm::dmat3 strain = glm::mat3_cast(glm::angleAxis(2.2, glm::normalize(DVec3(1, 3, 2)))) *
                            glm::dmat3(DVec3(1.3, 0.2, 0), DVec3(0.1, 0.8, 0.1), DVec3(0, 0, 1.1));
  const DVec3 shift(0.2, -0.1, 0.05);
  std::vector<Vec3> displacements, velocities;
  for (const Vec3& rest : solid.lattice.rest()) {
    displacements.emplace_back(strain * DVec3(rest) + shift - DVec3(rest));
    velocities.emplace_back(3.0 * DVec3(rest));
  }
  world.setDisplacements(displacements);
  world.setVelocities(velocities);
  world.makeFrame(frame);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const DVec3 rest(points[i].rest);
    REQUIRE(glm::length(DVec3(frame.positions[i]) - (strain * rest + shift)) < 1e-6);
    REQUIRE(glm::length(DVec3(frame.velocities[i]) - 3.0 * rest) < 1e-6);
    const DVec3 normal = glm::normalize(glm::transpose(glm::inverse(strain)) * DVec3(points[i].normal));
    REQUIRE(glm::length(DVec3(frame.normals[i]) - normal) < 1e-5);
  }
}

TEST_CASE_FIXTURE(GpuFixture,
                  "points are written to a live cloud in its units, relative to its origin, with their ids") {
  const MatterScene scene = snug({3, 2, 2});
  GpuSoftWorld world(device, device.latencyQueue(), scene);
  run(world, 3);
  CloudFrame frame;
  world.makeFrame(frame);
  const std::size_t count = frame.size();
  const auto room = [&] { return Buffer::of<Vec4>(device, count, Memory::device, "carried"); };
  const Buffer positions = room(), normals = room(), velocities = room();
  CommandList list(device, device.latencyQueue(), "carry");
  list.begin();
  world.recordFrame(list, {.positions = positions.address(),
                           .normals = normals.address(),
                           .velocities = velocities.address(),
                           .unitsPerMetre = 1e3,
                           .origin = {5, 6, 7}});
  list.end();
  device.latencyQueue().run(list);
  const auto places = download<Vec4>(device, positions, count), upright = download<Vec4>(device, normals, count),
             speeds = download<Vec4>(device, velocities, count);
  for (std::size_t i = 0; i < count; ++i) {
    REQUIRE(std::bit_cast<std::uint32_t>(places[i].w) == i);
    REQUIRE(glm::length(Vec3(places[i]) - (1e3f * frame.positions[i] - Vec3(5, 6, 7))) < 1e-5f);
    REQUIRE(upright[i] == Vec4(frame.normals[i], 0));
    REQUIRE(glm::length(Vec3(speeds[i]) - 1e3f * frame.velocities[i]) < 1e-3f);
  }
}

TEST_CASE("skin cells come first in the layout, with their positions, and each corner is read by its node only") {
  const MatterScene scene = snug({9, 8, 7});
  const SoftSolid solid = solidOf(scene);
  const SoftMaterial material = materialOf(scene);
  const std::vector<SkinPlace> skin =
      skinOf(solid.lattice, nodeMasses(solid.lattice, 1), solid.surface, touchFrequency(material, 0.005));
  const SoftLayout layout(solid.lattice, skin);
  CHECK(layout.skinCount == 9 * 8 * 7 - 7 * 6 * 5);
  CHECK(layout.firstInner == 512);
  CHECK(layout.slots - layout.firstInner == 7 * 6 * 5);
  CHECK(layout.stride > layout.slots);
  REQUIRE(layout.skinCells.size() == layout.skinCount + 1);
  CHECK(layout.skinCells.front().first == 0);
  CHECK(layout.skinCells.back().first == skin.size());
  // Each position rests in the cell whose range contains it.
  for (std::size_t c = 0; c + 1 < layout.skinCells.size(); ++c) {
    REQUIRE(layout.skinCells[c].first < layout.skinCells[c + 1].first);
    for (std::uint32_t at = layout.skinCells[c].first; at < layout.skinCells[c + 1].first; ++at) {
      const Vec3 rest(layout.skin[2 * at + 1]), share(layout.skin[2 * at]);
      REQUIRE(glm::length(rest - (layout.skinCells[c].corner + 0.005f * share)) < 1e-6f);
    }
  }
  // Each word of the planes along x belongs to one node, which is that corner of the cell; other corners read the zero
  // slot.
  std::vector<int> readers(std::size_t{layout.stride} * shared::kForcePlanes, 0);
  for (std::size_t node = 0; node < solid.lattice.nodes(); ++node)
    for (int k = 0; k < 8; ++k) {
      const std::uint32_t word = layout.incident[2 * node + k / 4][k % 4];
      const std::uint32_t slot = word % layout.stride, corner = word / layout.stride / 3;
      if (slot == layout.slots) continue;
      ++readers[word];
      REQUIRE(word / layout.stride % 3 == 0);
      REQUIRE(layout.corners[slot][static_cast<int>(corner / 2)] + corner % 2 == node);
    }
  CHECK(std::accumulate(readers.begin(), readers.end(), 0) == 8 * 9 * 8 * 7);
  CHECK(*std::ranges::max_element(readers) == 1);
  CHECK(layout.volumes[layout.slots] == 0);
}

TEST_CASE("no skin position leaves its cell's corners by more than the pass's search margin") {
  const MatterScene scene = snug({2, 2, 2});
  const SoftSolid solid = solidOf(scene);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> anywhere(-1, 1);
  CHECK(SoftLayout(solid.lattice, std::vector<SkinPlace>{{.at = {.cell = 0, .share = {0, 1, 0.5f}}}}).beyond < 1e-5f);
  for (const float most : {0.01f, 0.1f, 0.4f}) {
    CAPTURE(most);
    const std::array<SkinPlace, 2> skin{SkinPlace{.at = {.cell = 0, .share = {0.5f, -most, 0.2f}}},
                                        SkinPlace{.at = {.cell = 3, .share = {0.3f, 1, 0.5f + most}}}};
    const float beyond = SoftLayout(solid.lattice, skin).beyond;
    float farthest = 0;
    for (int k = 0; k < 20000; ++k) {
      // The distance is largest at the extremes of the shares.
      const auto end = [&] { return anywhere(random) > 0 ? 1 + most : -most; };
      const Vec3 share(end(), end(), end());
      float low = 1, high = -1, place = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const float at = anywhere(random) > 0 ? 1.0f : -1.0f;
        low = std::min(low, at);
        high = std::max(high, at);
        place += shared::cornerShare(share, corner) * at;
      }
      const float over = std::max(place - high, low - place);
      REQUIRE(over <= beyond * (high - low) + 1e-5f);
      farthest = std::max(farthest, over / std::max(high - low, 1e-9f));
    }
    CHECK(farthest > 0.9f * beyond);
  }
}

TEST_SUITE_END();

}  // namespace palpate::small_soft_test
