#pragma once

#include <functional>
#include <span>
#include <string>

#include "engine/core/point_state.hpp"
#include "engine/mesh/mesh.hpp"
#include "engine/mesh/mesh_passes.hpp"
#include "engine/mesh/mesh_plan.hpp"
#include "engine/mesh/mesh_points.hpp"
#include "engine/mesh/mesh_storage.hpp"
#include "engine/spatial/prefix_scan.hpp"

namespace palpate {

/// Where the time of a mesh went, us on the GPU; 0 where the device keeps no time.
struct MeshTimes {
  double index = 0;      ///< the hash of the points
  double list = 0;       ///< which blocks there are
  double field = 0;      ///< the value of every node
  double classify = 0;   ///< what every cell holds
  double scan = 0;       ///< where its vertices and triangles go
  double vertices = 0;   ///< places and normals
  double triangles = 0;  ///< their numbers
  double total() const { return index + list + field + classify + scan + vertices + triangles; }
};

struct MeshStep {
  MeshTimes gpu_us;
  std::uint32_t blocks = 0;   ///< that are there
  std::uint32_t treated = 0;  ///< whose nodes were computed; the others were carried over
};

/// Marching cubes (Lorensen and Cline 1987; cases as in engine/mesh/cell_table.hpp) over the implicit surface of a
/// cloud on the GPU. Only blocks of 8 x 8 x 8 cells near points are stored and treated. Passes: hash, mark blocks,
/// scan, list; value of every node; classify cells; scan; vertices, each placed on its edge and given its normal by a
/// pass over the points there; triangles. After an edit the nodes and vertices of blocks that it may have changed are
/// made anew, the others' are copied, and the result is that of a build from nothing, bit by bit: points are visited
/// in an order that depends on where they are and on their numbers, and on nothing else. (Places where more than
/// kMeshMostCandidates points crowd are the exception.) Belongs to the sight side.
class MarchingCubes {
 public:
  /// `cloud` must have normals. `spare`: points that edits may add. `painted`: edits may give colours
  /// where the cloud has none. Uploads the cloud. Throws OutOfGpuMemory.
  MarchingCubes(Device& device, const PointCloud& cloud, const MeshPlan& plan, std::uint32_t spare = 0,
                bool painted = false);

  /// Meshes the whole cloud, and waits. Throws OutOfGpuMemory.
  MeshStep build();
  /// Sets points to what `edits` say, in order, and follows with the mesh. What leaves the lattice is not meshed.
  MeshStep update(std::span<const PointState> edits);

  std::uint32_t vertexCount() const { return vertexCount_; }
  std::uint32_t triangleCount() const { return triangleCount_; }
  /// vertexCount() shared::MeshVertex.
  const Buffer& vertices() const { return storage_.now().vertices; }
  /// Three uint32 for each triangle, anticlockwise as seen from outside.
  const Buffer& triangles() const { return storage_.triangles(); }
  bool hasColors() const { return points_.hasColors(); }
  const MeshPlan& plan() const { return plan_; }
  Mesh download() const;
  /// What it holds on the GPU at present.
  std::uint64_t bytes() const { return points_.bytes() + storage_.bytes(); }

 private:
  MeshStep remesh(bool update);
  void listBlocks(MeshStep& step);
  void fillLattice(MeshStep& step, bool update);
  /// Runs a pass over all blocks, in parts of so many that a job which may be cut ends soon; its time on the GPU, us.
  double runOverBlocks(const std::string& name, bool update,
                       const std::function<void(CommandList&, const shared::MeshArgs&)>& record);
  void writeTriangles(MeshStep& step, bool update);
  void writeAddresses();
  shared::MeshArgs args(std::uint64_t count, bool update = false) const;

  Device& device_;
  MeshPlan plan_;
  MeshPoints points_;
  MeshStorage storage_;
  MeshPasses passes_;
  PrefixScan scan_;
  std::uint32_t slots_ = 0, vertexCount_ = 0, triangleCount_ = 0;
};

}  // namespace palpate
