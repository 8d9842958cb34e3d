#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/frame_carrier.hpp"
#include "engine/matter/soft_contact.hpp"
#include "engine/matter/soft_lattice.hpp"
#include "shaders/shared/soft_passes.h"

namespace palpate {

/// Memory layout of the cells, nodes and skin of a soft body on a GPU (shaders/shared/soft_passes.h).
struct SoftLayout {
  using Four = glm::uvec4;

  /// `skin`: in any order.
  SoftLayout(const SoftLattice& lattice, std::span<const SkinPlace> skin);

  std::uint32_t skinCount = 0;   ///< number of cells with skin positions; in the first slots
  std::uint32_t firstInner = 0;  ///< slot of the first cell without skin, at the beginning of a block
  std::uint32_t slots = 0;
  std::uint32_t stride = 0;  ///< stride of planes, in floats
  float beyond = 0;          ///< shared::SoftSetting::beyond

  std::vector<std::uint32_t> slotOf;  ///< slot of each cell of the lattice
  std::vector<Four> corners;          ///< per slot
  std::vector<float> volumes;         ///< per slot, and for the slot of the empty cell, m^3
  std::vector<Four> incident;         ///< per node
  std::vector<shared::SoftSkinCell> skinCells;
  std::vector<Vec4> skin;         ///< by cell, in the order of the cells
  std::vector<Vec4> skinNormals;  ///< likewise: normal at rest, and the bits of the position's original number
  std::uint32_t skinNodes = 0;    ///< number of nodes with a share in a skin position

 private:
  void placeCells(const SoftLattice& lattice, std::span<const SkinPlace> places);
  void placeSkin(const SoftLattice& lattice, std::span<const SkinPlace> places);
};

class GpuSoftPress;

/// Sizes of a soft body on a GPU.
struct SoftSizes {
  std::uint32_t nodes = 0;
  std::uint32_t skinCount = 0, firstInner = 0, slots = 0, stride = 0;  ///< as in SoftLayout
  std::uint32_t skinNodes = 0;                                         ///< as in SoftLayout
  std::uint32_t skin = 0;                                              ///< number of skin positions
  std::uint32_t points = 0;                                            ///< number of points that it carries
  std::uint32_t tools = 0;
  std::uint32_t substeps = 1;  ///< per step
  bool hasPins = false;
  bool isSculpted = false;  ///< cells may have rest shapes other than a cube

  std::uint32_t cellBlocks() const;  ///< blocks of slots
  std::uint32_t nodeBlocks() const;
};

/// Buffers of the passes of a soft body; shaders/shared/soft_passes.h defines their layouts. Throws OutOfGpuMemory.
struct SoftMemory {
  SoftMemory(Device& device, const SoftSizes& sizes);

  /// Offsets of the parts of `state`, which is copied to the host as a whole.
  static constexpr std::uint64_t kSums = 0, kTools = 60;
  std::uint64_t bytes() const;

  /// Allocates the rest shapes of the cells, all cubes, if not yet allocated.
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
  std::optional<Buffer> rests;  // shared::CellRest per slot, written by the host; if the body was sculpted
};

/// The passes of a soft body on a GPU. A substep has two: cells, with the contacts of their skin, then nodes, with the
/// tools. All are gathers, and sums have a fixed order.
class SoftPasses {
 public:
  explicit SoftPasses(Device& device);

  /// Records a step of all substeps, with the presses of `press`, or none if null. Its report is in SoftMemory::state.
  void recordStep(CommandList& list, const SoftMemory& memory, const SoftSizes& sizes, const GpuSoftPress* press) const;
  /// Call once before the first step of a sculpted body.
  void holdShapes(Device& device);
  /// A pass for recordTrial().
  static ComputePipeline trialPass(Device& device, const SoftSizes& sizes);
  /// Records the forces of the cells and the walls for slightly displaced nodes, into SoftMemory::forces.
  static void recordTrial(CommandList& list, const ComputePipeline& pass, const SoftMemory& memory,
                          const SoftSizes& sizes, DeviceAddress nodes);
  /// Records the points at the nodes' present positions. Only reads data that a step writes.
  void recordFrame(CommandList& list, const SoftMemory& memory, const SoftSizes& sizes, const CarriedPoints& to) const;

 private:
  struct Cells {
    const ComputePipeline& pass;
    DeviceAddress nodes, tools;
    std::uint32_t toolCount;
    bool begins, ends;  // whether the substep is the first or the last one of its step
  };
  static void recordCells(CommandList& list, const SoftMemory& memory, const SoftSizes& sizes, const Cells& cells);
  void recordNodes(CommandList& list, const SoftMemory& memory, const SoftSizes& sizes, std::uint32_t substep) const;

  ComputePipeline predict_, cells_, nodes_, finish_, strain_, blend_, carry_;
  std::optional<ComputePipeline> sculptedCells_;
};

}  // namespace palpate
