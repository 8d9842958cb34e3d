// Meshes from the GPU: closed if the shape is, equal to those in double precision, and true to the shape.
#include "engine/mesh/marching_cubes.hpp"

#include "tests/labels.hpp"
#include "tests/mesh_gpu/mesh_scenes.hpp"
#include "tests/near.hpp"

namespace palpate::marching_cubes_test {

namespace {

struct Truth {
  const char* shape;
  std::size_t points;
  std::int64_t euler;
  double volume;  // of a shape of size 100; 0: not known in closed form
};

}  // namespace

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "the mesh of a closed shape is closed, faces outwards and has the shape's Euler number" *
                      kMoreInFull) {
  const Truth truths[]{{"sphere", 6000, 2, 4 * 3.14159265358979 / 3 * 125'000},
                       {"torus", 8000, 0, 2 * 3.14159265358979 * 3.14159265358979 * 35 * 225},
                       {"bumpy-sphere", 8000, 2, 0},
                       {"cube", 8000, 2, 1e6}};
  for (const Truth& truth : truths)
    for (const std::uint32_t resolution : byTier<std::vector<std::uint32_t>>({13, 32}, {13, 32, 50})) {
      CAPTURE(truth.shape);
      CAPTURE(resolution);
      const MeshScene scene = meshScene(truth.shape, truth.points, {.resolution = resolution});
      const Mesh mesh = meshOnGpu(device, scene);
      checkClosed(mesh);
      const MeshReport report = examine(mesh);
      CHECK(report.euler() == truth.euler);
      CHECK(report.parts == 1);
      // The tube of the torus is narrower than the support radius of the coarsest lattice.
      if (truth.volume > 0) CHECK(report.volume == near(truth.volume, resolution < 20 ? 0.05 : 0.01));
      CHECK(report.volume > 0);
    }
}

TEST_CASE_FIXTURE(CoreGpuFixture, "the GPU's mesh has the triangles and vertices of double precision") {
  for (const auto& [name, surface] : kMeshSurfaces)
    for (const char* shape : {"torus", "cube"}) {
      CAPTURE(name);
      CAPTURE(shape);
      // Three passes over the points are many loop iterations for an instrumented shader: a smaller support reduces
      // them.
      const bool sharp = surface == MeshSurface::sharp;
      const MeshScene scene =
          meshScene(shape, 2500, {.resolution = sharp ? 26u : 17u, .surface = surface, .radius = sharp ? 9.0 : 0.0});
      const Mesh mesh = meshOnGpu(device, scene), expected = meshReference(scene.cloud, scene.plan);
      CHECK(mesh.triangles.size() > 500);
      CHECK(mesh.triangles == expected.triangles);
      REQUIRE(mesh.vertices.size() == expected.vertices.size());
      float farthest = 0, worstCosine = 1;
      for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        farthest = std::max(farthest, glm::distance(mesh.vertices.positions[i], expected.vertices.positions[i]));
        worstCosine = std::min(worstCosine, glm::dot(mesh.vertices.normals[i], expected.vertices.normals[i]));
      }
      CHECK(farthest < 1e-3f * scene.plan.lattice.cell);
      CHECK(worstCosine > 0.9999f);
    }
}

}  // namespace palpate::marching_cubes_test
