// Edge cases: no points, hardly any, all at one position, far away, an open surface, exactly on the lattice.
#include "engine/gpu/device.hpp"
#include "engine/mesh/mesh_memory.hpp"
#include "tests/mesh_gpu/mesh_scenes.hpp"
#include "tests/near.hpp"

namespace palpate::mesh_edges_test {

namespace {

PointCloud pointsAt(std::vector<Vec3> positions, const Vec3& normal = Vec3(0, 0, 1)) {
  PointCloud cloud;
  cloud.normals.assign(positions.size(), normal);
  cloud.positions = std::move(positions);
  return cloud;
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "empty, tiny and coincident clouds give no mesh or an open one, as in double precision") {
  for (const auto& [name, surface] : kMeshSurfaces)
    for (const std::size_t count : {0u, 1u, 2u, 60u}) {
      CAPTURE(name);
      CAPTURE(count);
      const MeshScene scene = meshScene(pointsAt(std::vector<Vec3>(count, Vec3(1, -2, 3))), {.surface = surface});
      const Mesh mesh = meshOnGpu(device, scene);
      const MeshReport report = examine(mesh);
      CHECK(report.crowdedEdges == 0);
      CHECK(report.flat == 0);
      if (count < 3) CHECK(report.triangles == 0);
      if (count == 60) CHECK(report.triangles > 0);
      CHECK(mesh.triangles == meshReference(scene.cloud, scene.plan).triangles);
    }
}

TEST_CASE_FIXTURE(GpuFixture, "a plane gives one open sheet that ends near its last points") {
  const MeshScene scene = meshScene("plane", 3000, {.resolution = 40});
  const Mesh mesh = meshOnGpu(device, scene);
  const MeshReport report = examine(mesh);
  CHECK(report.parts == 1);
  CHECK(report.crowdedEdges == 0);
  CHECK(report.turnedEdges == 0);
  CHECK(report.flat == 0);
  CHECK(report.borderEdges > 100);
  CHECK(report.euler() == 1);  // a disc
  const float reach = scene.plan.lattice.radius;
  for (const Vec3& place : mesh.vertices.positions) {
    CHECK(std::abs(place.z) < 1e-3f);
    CHECK(std::abs(place.x) < 50 + 0.7f * reach);
    CHECK(std::abs(place.y) < 50 + 0.7f * reach);
  }
  CHECK(report.area > 1e4);
}

TEST_CASE_FIXTURE(GpuFixture, "lattices of one or few cells, and of no multiple of a block, are meshed") {
  for (const std::uint32_t resolution : {1u, 2u, 3u, 7u, 8u, 9u, 17u}) {
    CAPTURE(resolution);
    const MeshScene scene = meshScene("sphere", 1500, {.resolution = resolution});
    const Mesh mesh = meshOnGpu(device, scene);
    CHECK(examine(mesh).crowdedEdges == 0);
    CHECK(examine(mesh).flat == 0);
    if (resolution >= 7) checkClosed(mesh);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "a mesh far from zero or at negative coordinates is the same up to rounding") {
  const MeshScene here = meshScene("torus", 3000, {.resolution = 24});
  const Mesh expected = meshOnGpu(device, here);
  for (const DVec3& center : {DVec3(-300, -700, -900), DVec3(5e6, -3e6, 1e6)}) {
    const MeshScene far = meshScene("torus", 3000, {.resolution = 24}, center);
    const Mesh mesh = meshOnGpu(device, far);
    checkClosed(mesh);
    CHECK(examine(mesh).euler() == 0);
    CHECK(examine(mesh).volume == near(examine(expected).volume, 1e-3));
    CHECK(glm::distance(mesh.vertices.fileCoordinates(0), center) < 60);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "a surface exactly through lattice nodes has no hole and no flat triangle") {
  // A box of points whose sides lie on planes of nodes: the field there is zero, within rounding.
  PointCloud cloud;
  constexpr int kSide = 24;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j)
        for (const float end : {0.0f, 1.0f}) {
          Vec3 place(0), normal(0);
          place[axis] = end * kSide;
          place[(axis + 1) % 3] = static_cast<float>(i) + 0.5f;
          place[(axis + 2) % 3] = static_cast<float>(j) + 0.5f;
          normal[axis] = end * 2 - 1;
          cloud.positions.push_back(place);
          cloud.normals.push_back(normal);
        }
  for (const MeshSurface surface : {MeshSurface::average, MeshSurface::sphere}) {
    MeshScene scene = meshScene(cloud, {.resolution = kSide, .surface = surface});
    scene.plan.lattice.origin = Vec3(-8);
    scene.plan.lattice.cell = 1;
    scene.plan.lattice.blocks = {5, 5, 5};
    const Mesh mesh = meshOnGpu(device, scene);
    checkClosed(mesh);
    CHECK(examine(mesh).euler() == 2);
    CHECK(examine(mesh).volume == near(kSide * kSide * kSide, 0.06));
  }
}

TEST_CASE_FIXTURE(CoreGpuFixture, "a lattice with more blocks than one axis of a dispatch allows is meshed") {
  // Two small patches in opposite corners of a lattice of 2048 cells: some seventeen million blocks, most of them
  // empty.
  std::vector<Vec3> places;
  for (const float corner : {0.0f, 2048.0f})
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j)
        places.emplace_back(corner + static_cast<float>(i), corner + static_cast<float>(j), corner);
  const MeshScene scene = [&] {
    MeshScene made{.cloud = pointsAt(places), .spacing = 1};
    made.plan = planMesh(boundsOf(made.cloud), 1, {.resolution = 2048});
    return made;
  }();
  CHECK(shared::blockCount(scene.plan.lattice) > 256u * 65'535);
  const Mesh mesh = meshOnGpu(device, scene);
  const MeshReport report = examine(mesh);
  CHECK(report.parts == 2);
  CHECK(report.euler() == 2);  // two discs
  CHECK(report.crowdedEdges == 0);
}

TEST_CASE_FIXTURE(GpuFixture, "the memory of a mesh is predicted before it is built, and refused if it does not fit") {
  for (const std::uint32_t resolution : {16u, 40u}) {
    const MeshScene scene = meshScene("bumpy-sphere", 4000, {.resolution = resolution});
    const MeshMemory predicted = predictMeshMemory(scene.cloud, scene.plan);
    MarchingCubes cubes(device, scene.cloud, scene.plan);
    CHECK(cubes.build().blocks == predicted.blocks);
    CHECK(predicted.total() >= 0.9 * static_cast<double>(cubes.bytes()));
    CHECK(predicted.total() <= 2 * cubes.bytes());
    requireMeshMemory(device, predicted);
  }
  CHECK_THROWS_AS(requireMeshMemory(device, {.lattice = device.ownMemory() + 1}), OutOfGpuMemory);
  CHECK_THROWS_AS(planMesh({DVec3(0), DVec3(1)}, 0.5, {.resolution = kMaxResolution}), Error);
}

TEST_CASE_FIXTURE(GpuFixture, "vertices get the colours of the points around them") {
  MeshScene scene = meshScene("sphere", 3000, {.resolution = 20});
  for (const Vec3& place : scene.cloud.positions)
    scene.cloud.colors.push_back(place.x > 0 ? std::array<std::uint8_t, 4>{255, 0, 0, 255}
                                             : std::array<std::uint8_t, 4>{0, 0, 255, 255});
  const Mesh mesh = meshOnGpu(device, scene);
  REQUIRE(mesh.vertices.colors.size() == mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const float x = mesh.vertices.positions[i].x;
    if (std::abs(x) < scene.plan.lattice.radius) continue;
    CHECK(mesh.vertices.colors[i][0] == (x > 0 ? 255 : 0));
    CHECK(mesh.vertices.colors[i][2] == (x > 0 ? 0 : 255));
  }
}

}  // namespace palpate::mesh_edges_test
