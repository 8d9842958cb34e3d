#pragma once

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// Sizes of a simulation on a GPU.
struct MatterSizes {
  std::uint32_t particles = 0;
  std::uint32_t blocks = 0;  ///< of shared::kMatterBlock slots
  std::uint32_t cells = 0;   ///< cells of the box
  std::uint32_t tools = 0;
  std::uint32_t bodyPoints = 0;  ///< points of a tool's ball
  std::uint32_t bodyCells = 0;
  std::uint32_t modelNodes = 0;  ///< nodes of the field around a model; 0: no model
  std::uint32_t substeps = 1;    ///< per step
  std::uint32_t mostListed = 0;  ///< maximum number of neighbours in a list
  bool remembers = false;        ///< whether contacts of particles store state

  std::uint32_t stride() const;  ///< stride of the lists, in slots
  std::uint32_t tiles() const;   ///< number of tiles of the scan over all cells
};

/// Buffers of the matter passes; shaders/shared/matter_passes.h defines their layouts. Throws OutOfGpuMemory.
struct MatterMemory {
  MatterMemory(Device& device, const MatterSizes& sizes);

  /// Offsets of the parts of `state`, which is copied to the host as a whole.
  static constexpr std::uint64_t kControl = 0, kSums = 32, kTools = 92;
  std::uint64_t bytes() const;

  Buffer setting, hands;
  Buffer state, stateRead;
  struct Particles {
    Buffer places, positions, velocities, ids;
  } particles, sorted;
  Buffer pressed;
  Buffer lists, listLengths;
  struct Sort {
    Buffer firsts, tileSums, cells, arrivals, order;
  } sort;
  Buffer sums;
  Buffer bodyPoints, bodyFirsts;
  Buffer contacts, contactCounts;
};

/// The passes of one substep of matter on a GPU. The host does not intervene: the GPU decides whether the lists are
/// still valid, and if so the passes that build them end at once. Even these cost time on a GPU, so there are substeps
/// without them. No sum and no order depends on the order of execution.
class MatterPasses {
 public:
  MatterPasses(Device& device, Matter matter);

  /// Records substep `substep` of a step, the first of `listsFor` substeps until lists can be rebuilt; 0: this substep
  /// builds none.
  void record(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes, std::uint32_t substep,
              std::uint32_t listsFor) const;

 private:
  void recordPrediction(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes, std::uint32_t substep,
                        std::uint32_t ahead) const;
  void recordSort(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes) const;
  void recordLists(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes) const;
  void recordWater(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes) const;
  void recordSand(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes) const;
  void recordFinish(CommandList& list, const MatterMemory& memory, const MatterSizes& sizes, std::uint32_t substep,
                    bool makesLists) const;

  Matter matter_;
  ComputePipeline predict_, count_, scanReduce_, scan_, place_, sort_, list_, compress_, push_, rub_, finish_;
};

}  // namespace palpate
