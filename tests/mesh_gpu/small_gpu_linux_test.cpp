// Meshes on a GPU with small workgroups.
#include "engine/mesh/marching_cubes.hpp"

#include "tests/labels.hpp"
#include "tests/lost_gpu/lost_gpu.hpp"
#include "tests/mesh_gpu/mesh_scenes.hpp"

namespace palpate::small_gpu_test {

TEST_SUITE_BEGIN(kPortable);

TEST_CASE("a GPU with small workgroups gives the same mesh") {
  const MeshScene scene = meshScene("torus", 8000, {.resolution = 32});
  const Mesh expected = meshOnGpu(plainDevice(), scene);
  const LostGpuLayer layer(kMinGpu);
  Device small({.gpu = "", .validation = askedCoreValidation()});
  const Mesh mesh = meshOnGpu(small, scene);
  checkClosed(mesh);
  CHECK(mesh.triangles == expected.triangles);
  REQUIRE(mesh.vertices.size() == expected.vertices.size());
  float farthest = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    farthest = std::max(farthest, glm::distance(mesh.vertices.positions[i], expected.vertices.positions[i]));
  CHECK(farthest < 1e-3f * scene.plan.lattice.cell);
  small.waitIdle();
  CHECK(small.instance().messages().take().empty());
}

TEST_SUITE_END();

}  // namespace palpate::small_gpu_test
