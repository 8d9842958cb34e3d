#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/mesh/mesh_plan.hpp"

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

}  // namespace palpate
