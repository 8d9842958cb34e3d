#pragma once

#include <functional>
#include <span>
#include <string>

#include "engine/core/point_state.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/mesh/mesh.hpp"
#include "engine/mesh/mesh_plan.hpp"
#include "engine/mesh/mesh_points.hpp"
#include "engine/mesh/mesh_storage.hpp"
#include "engine/spatial/prefix_scan.hpp"

namespace palpate {

/// The passes of MarchingCubes, in order. Each receives in `args` its number of points or blocks.
class MeshPasses {
 public:
  /// `colored`: vertices get colours.
  MeshPasses(Device& device, const MeshPlan& plan, bool colored);

  /// Marks the blocks near points.
  void recordMark(CommandList& list, shared::MeshArgs args) const;
  /// Lists the marked blocks.
  void recordList(CommandList& list, const shared::MeshArgs& args) const;
  /// Updates only: the blocks that moved points may have changed.
  void recordTouch(CommandList& list, shared::MeshArgs args) const;
  /// The value of every node.
  void recordField(CommandList& list, const shared::MeshArgs& args) const;
  /// The case of every cell.
  void recordClassify(CommandList& list, const shared::MeshArgs& args) const;
  /// Number of vertices and triangles of each block.
  void recordCount(CommandList& list, const shared::MeshArgs& args) const;
  void recordVertices(CommandList& list, const shared::MeshArgs& args) const;
  void recordTriangles(CommandList& list, const shared::MeshArgs& args) const;

 private:
  ComputePipeline mark_, list_, touch_, field_, classify_, count_, vertices_, triangles_;
};

/// GPU time of a mesh by pass, us; 0 if the device has no timestamps.
struct MeshTimes {
  double index = 0;      ///< the hash of the points
  double list = 0;       ///< listing the blocks
  double field = 0;      ///< the value of every node
  double classify = 0;   ///< case of every cell
  double scan = 0;       ///< offsets of vertices and triangles
  double vertices = 0;   ///< positions and normals
  double triangles = 0;  ///< vertex indices
  double total() const { return index + list + field + classify + scan + vertices + triangles; }
};

struct MeshStep {
  MeshTimes gpu_us;
  std::uint32_t blocks = 0;   ///< number of blocks
  std::uint32_t treated = 0;  ///< number of blocks whose nodes were computed; the others were copied
};

/// Marching cubes (Lorensen and Cline 1987; cases as in engine/mesh/cell_table.hpp) over the implicit surface of a
/// cloud on the GPU. Only blocks of 8 x 8 x 8 cells near points are stored and processed. Passes: hash, mark blocks,
/// scan, list; value of every node; classify cells; scan; vertices, each with a position on its edge and a normal from
/// a pass over nearby points; triangles.
/// After an edit the nodes and vertices of blocks that it may have changed are computed again, the others are copied.
/// The result equals that of a new build, bit by bit: points are visited in an order that depends only on their
/// positions and numbers (except where more than kMeshMaxCandidates points crowd). Part of the sight side.
class MarchingCubes {
 public:
  /// `cloud` must have normals. `spare`: number of points that edits may add. `painted`: edits may set colours although
  /// the cloud has none. Uploads the cloud. Throws OutOfGpuMemory.
  MarchingCubes(Device& device, const PointCloud& cloud, const MeshPlan& plan, std::uint32_t spare = 0,
                bool painted = false);

  /// Meshes the whole cloud, and waits. Throws OutOfGpuMemory.
  MeshStep build();
  /// Applies `edits` to the points in order, and updates the mesh. Points outside the lattice are not meshed.
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
  /// GPU memory in use.
  std::uint64_t bytes() const { return points_.bytes() + storage_.bytes(); }

 private:
  MeshStep remesh(bool update);
  void listBlocks(MeshStep& step);
  void fillLattice(MeshStep& step, bool update);
  /// Runs a pass over all blocks, split into parts so that an interruptible job ends soon; returns its GPU time, us.
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
