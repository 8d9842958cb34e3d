#pragma once

#include <optional>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/frame_carrier.hpp"
#include "engine/matter/soft_layout.hpp"

namespace palpate {

class GpuSoftPress;

/// How much of everything a soft body on a GPU has.
struct SoftSizes {
  std::uint32_t nodes = 0;
  std::uint32_t skinCount = 0, firstInner = 0, slots = 0, stride = 0;  ///< SoftLayout's
  std::uint32_t skinNodes = 0;                                         ///< SoftLayout's
  std::uint32_t skin = 0;                                              ///< places
  std::uint32_t points = 0;                                            ///< that it carries
  std::uint32_t tools = 0;
  std::uint32_t substeps = 1;  ///< in a step
  bool hasPins = false;
  bool isSculpted = false;  ///< cells may have another rest shape than a cube

  std::uint32_t cellBlocks() const;  ///< of slots
  std::uint32_t nodeBlocks() const;
};

/// What the passes of a soft body work on: shaders/shared/soft_passes.h says what stands in each. Throws
/// OutOfGpuMemory.
struct SoftMemory {
  SoftMemory(Device& device, const SoftSizes& sizes);

  /// Parts of `state`, which is copied to the host as a whole.
  static constexpr std::uint64_t kSums = 0, kTools = 60;
  std::uint64_t bytes() const;

  /// Makes room for the rest shapes of cells, all of them cubes, where there is none.
  void holdShapes(Device& device, const SoftSizes& sizes);

  Buffer setting, hands;
  Buffer state, stateRead;
  Buffer nodes, corners, volumes, incident;
  Buffer skinCells, skin, skinNormals;
  Buffer forces, cellSums, nodeSums;
  struct Points {
    Buffer rests, shares, normalRests;
  } points;
  Buffer gradients, nodeGradients;
  std::optional<Buffer> rests;  // shared::CellRest of each slot, written by the host; where the body was sculpted
};

/// The passes of a soft body on a GPU. A substep is two: cells, with what presses on their skin, then nodes, with the
/// tools. All are gathers, and sums have one order.
class SoftPasses {
 public:
  explicit SoftPasses(Device& device);

  /// A step of all substeps, with the presses that `press` has; null: nobody presses. Its report stands in
  /// SoftMemory::state.
  void recordStep(CommandList& list, const SoftMemory& memory, const SoftSizes& sizes, const GpuSoftPress* press) const;
  /// Once before the first step of a body that was sculpted.
  void holdShapes(Device& device);
  /// A pass for recordTrial().
  static ComputePipeline trialPass(Device& device, const SoftSizes& sizes);
  /// What the cells and the walls do to nodes that have gone on a little, into SoftMemory::forces.
  static void recordTrial(CommandList& list, const ComputePipeline& pass, const SoftMemory& memory,
                          const SoftSizes& sizes, DeviceAddress nodes);
  /// The points as the nodes are. Reads what a step writes, and writes none of it.
  void recordFrame(CommandList& list, const SoftMemory& memory, const SoftSizes& sizes, const CarriedPoints& to) const;

 private:
  struct Cells {
    const ComputePipeline& pass;
    DeviceAddress nodes, tools;
    std::uint32_t toolCount;
    bool begins, ends;  // whether the substep is the first one of its step, and the last one
  };
  static void recordCells(CommandList& list, const SoftMemory& memory, const SoftSizes& sizes, const Cells& cells);
  void recordNodes(CommandList& list, const SoftMemory& memory, const SoftSizes& sizes, std::uint32_t substep) const;

  ComputePipeline predict_, cells_, nodes_, finish_, strain_, blend_, carry_;
  std::optional<ComputePipeline> sculptedCells_;
};

}  // namespace palpate
