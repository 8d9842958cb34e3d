#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/matter/matter_memory.hpp"

namespace palpate {

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
