// A mesh updated by edits equals a new build, bit by bit.
#include <random>

#include "tests/labels.hpp"
#include "tests/mesh_gpu/mesh_scenes.hpp"

namespace palpate::mesh_update_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

PointState stateOf(const PointCloud& cloud, std::uint32_t i) {
  return {.position = cloud.positions[i], .number = i, .normal = cloud.normals[i], .color = 0, .parent = i};
}

// Pushes the points near `center` inwards by up to `depth`, as a smooth dent, also in the cloud.
std::vector<PointState> dent(PointCloud& cloud, const Vec3& center, float radius, float depth) {
  std::vector<PointState> edits;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const float share = glm::distance(cloud.positions[i], center) / radius;
    if (share >= 1) continue;
    cloud.positions[i] -= depth * (1 - share * share) * cloud.normals[i];
    edits.push_back(stateOf(cloud, i));
  }
  return edits;
}

void checkSameAsFresh(Device& device, const MarchingCubes& followed, const PointCloud& cloud) {
  MarchingCubes fresh(device, cloud, followed.plan());
  fresh.build();
  CHECK(followed.vertexCount() == fresh.vertexCount());
  CHECK(followed.triangleCount() == fresh.triangleCount());
  CHECK(sameBits(followed.download(), fresh.download()));
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture,
                  "after dents the updated mesh equals a new build, and only blocks near them are processed") {
  // Two meshes at a time are many buffers for an instrumented shader: a smaller support reduces its loop iterations.
  MeshScene scene = meshScene("sphere", 4000, {.resolution = 42, .radius = 7.5});
  MarchingCubes cubes(device, scene.cloud, scene.plan);
  const MeshStep whole = cubes.build();
  CHECK(whole.treated == whole.blocks);
  for (const Vec3& center : {Vec3(50, 0, 0), Vec3(0, -35, 35), Vec3(48, 10, 0)}) {
    const MeshStep step = cubes.update(dent(scene.cloud, center, 10, 4));
    CHECK(step.treated > 0);
    CHECK(step.treated < step.blocks / 3);
    checkSameAsFresh(device, cubes, scene.cloud);
    checkClosed(cubes.download());
  }
}

TEST_CASE_FIXTURE(GpuFixture, "mesh updates handle points that jump, are removed, added and restored, anywhere") {
  MeshScene scene = meshScene("torus", 3000, {.resolution = 24, .room = 0.3});
  constexpr std::uint32_t kSpare = 40;
  MarchingCubes cubes(device, scene.cloud, scene.plan, kSpare);
  cubes.build();
  std::mt19937 random(3);
  std::uniform_real_distribution<float> anywhere(-70, 70);
  // Removed points keep their number: here they are moved outside the lattice.
  PointCloud after = scene.cloud;
  after.positions.resize(3000 + kSpare, Vec3(1e6f));
  after.normals.resize(3000 + kSpare, Vec3(0, 0, 1));
  for (int turn = 0; turn < 3; ++turn) {
    std::vector<PointState> edits;
    for (int k = 0; k < 30; ++k) {
      const auto number = static_cast<std::uint32_t>(random() % (3000 + kSpare));
      PointState state{.position = Vec3{anywhere(random), anywhere(random), anywhere(random)},
                       .number = number,
                       .normal = Vec3(0, 1, 0)};
      after.positions[number] = state.position;
      after.normals[number] = state.normal;
      if (k % 3 == 0) {
        state.gone = true;
        after.positions[number] = Vec3(1e6f);
      }
      edits.push_back(state);
    }
    cubes.update(edits);
    checkSameAsFresh(device, cubes, after);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "the later of two edits of a point counts, and no edit leaves the mesh unchanged") {
  MeshScene scene = meshScene("sphere", 2000, {.resolution = 16});
  MarchingCubes cubes(device, scene.cloud, scene.plan);
  cubes.build();
  const Mesh before = cubes.download();
  CHECK(cubes.update({}).treated == 0);
  CHECK(sameBits(cubes.download(), before));
  PointState there = stateOf(scene.cloud, 17), back = there;
  there.position += Vec3(3, 0, 0);
  cubes.update(std::vector{there, back});
  CHECK(sameBits(cubes.download(), before));
}

TEST_CASE_FIXTURE(GpuFixture, "a mesh of a subsampled cloud follows edits too") {
  MeshScene scene = meshScene("sphere", 12'000, {.resolution = 16});
  REQUIRE(scene.plan.share < 0.8);
  const Mesh followed = [&] {  // one at a time, since an instrumented shader has a limited number of loop iterations
    MarchingCubes cubes(device, scene.cloud, scene.plan);
    cubes.build();
    checkClosed(cubes.download());
    cubes.update(dent(scene.cloud, Vec3(0, 0, 50), 20, 10));
    return cubes.download();
  }();
  CHECK(sameBits(followed, meshOnGpu(device, scene)));
}

TEST_CASE_FIXTURE(GpuFixture, "all points may be removed from a mesh and restored") {
  MeshScene scene = meshScene("sphere", 500, {.resolution = 8});
  MarchingCubes cubes(device, scene.cloud, scene.plan);
  cubes.build();
  const Mesh before = cubes.download();
  std::vector<PointState> gone, back;
  for (std::uint32_t i = 0; i < scene.cloud.size(); ++i) {
    back.push_back(stateOf(scene.cloud, i));
    gone.push_back(back.back());
    gone.back().gone = true;
  }
  cubes.update(gone);
  CHECK(cubes.triangleCount() == 0);
  cubes.update(back);
  CHECK(sameBits(cubes.download(), before));
}

TEST_SUITE_END();

}  // namespace palpate::mesh_update_test
