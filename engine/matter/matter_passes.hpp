#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/matter/matter_memory.hpp"

namespace palpate {

/// The passes of one substep of matter on a GPU. The host is not asked in between: whether lists are still good is seen
/// there, and the passes that make them end at once where they are. But even these take their time on a GPU, and so
/// there are substeps without them. No sum and no order depends on who came first.
class MatterPasses {
 public:
  MatterPasses(Device& device, Matter matter);

  /// Substep `substep` of a step, the first of `listsFor` until lists can be made again; 0: none are made in it.
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
