#include "engine/study/gather_naive.hpp"

namespace palpate {

GatherNaive::GatherNaive(Device& device, std::uint32_t cells)
    : passes_(device, cells),
      commands_(Buffer::of<VkDispatchIndirectCommand>(device, cells, Memory::device, "gather commands")) {}

void GatherNaive::record(CommandList& list, std::uint32_t, const GatherIo& io) const {
  passes_.recordPlan(list, io, shared::kPlanCommands, commands_);
  const auto children = list.independent();
  for (std::uint32_t cell = 0; cell < passes_.cells(); ++cell)
    passes_.recordGather(list, io, commands_, cell * sizeof(VkDispatchIndirectCommand), cell);
}

}  // namespace palpate
