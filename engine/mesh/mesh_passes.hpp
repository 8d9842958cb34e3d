#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/mesh/mesh_plan.hpp"

namespace palpate {

/// The passes of MarchingCubes, in the order in which they run. Each takes in `args` how many points or blocks it goes
/// over.
class MeshPasses {
 public:
  /// `colored`: vertices get colours.
  MeshPasses(Device& device, const MeshPlan& plan, bool colored);

  /// Marks the blocks near points.
  void recordMark(CommandList& list, shared::MeshArgs args) const;
  /// Lists the blocks that are there.
  void recordList(CommandList& list, const shared::MeshArgs& args) const;
  /// Of an update: the blocks that moved points may have changed.
  void recordTouch(CommandList& list, shared::MeshArgs args) const;
  /// The value of every node.
  void recordField(CommandList& list, const shared::MeshArgs& args) const;
  /// What every cell holds.
  void recordClassify(CommandList& list, const shared::MeshArgs& args) const;
  /// How many vertices and triangles a block has.
  void recordCount(CommandList& list, const shared::MeshArgs& args) const;
  void recordVertices(CommandList& list, const shared::MeshArgs& args) const;
  void recordTriangles(CommandList& list, const shared::MeshArgs& args) const;

 private:
  ComputePipeline mark_, list_, touch_, field_, classify_, count_, vertices_, triangles_;
};

}  // namespace palpate
