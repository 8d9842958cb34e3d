#pragma once

#include "engine/mesh/marching_cubes.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/mesh_gpu/mesh_reference.hpp"
#include "tests/scenes.hpp"

namespace palpate {

/// A cloud and its meshing plan.
struct MeshScene {
  PointCloud cloud;
  double spacing = 0;
  MeshPlan plan;
};

inline MeshScene meshScene(PointCloud cloud, const MeshOptions& options) {
  MeshScene scene{.cloud = std::move(cloud)};
  scene.spacing = meanSpacing(scene.cloud);
  scene.plan = planMesh(boundsOf(scene.cloud), scene.spacing, options);
  return scene;
}

inline MeshScene meshScene(std::string_view shape, std::size_t count, const MeshOptions& options,
                           const DVec3& center = DVec3(0)) {
  return meshScene(sampleShape(*makeShape(shape, 100.0, center), {.count = count, .seed = 7}), options);
}

inline Mesh meshOnGpu(Device& device, const MeshScene& scene) {
  MarchingCubes cubes(device, scene.cloud, scene.plan);
  cubes.build();
  return cubes.download();
}

/// Closed, consistently oriented, without flat triangles or unused vertices.
inline void checkClosed(const Mesh& mesh) {
  const MeshReport report = examine(mesh);
  CHECK(report.triangles > 0);
  CHECK(report.borderEdges == 0);
  CHECK(report.crowdedEdges == 0);
  CHECK(report.turnedEdges == 0);
  CHECK(report.unused == 0);
  CHECK(report.flat == 0);
}

inline bool sameBits(const Mesh& a, const Mesh& b) {
  return a.vertices.positions == b.vertices.positions && a.vertices.normals == b.vertices.normals &&
         a.vertices.colors == b.vertices.colors && a.triangles == b.triangles;
}

}  // namespace palpate
