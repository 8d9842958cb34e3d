#include "engine/study/gather_indirect.hpp"

namespace palpate {

GatherIndirect::GatherIndirect(Device& device, std::uint32_t cells)
    : passes_(device, cells),
      command_(Buffer::of<VkDispatchIndirectCommand>(device, 1, Memory::device, "gather command")) {}

void GatherIndirect::record(CommandList& list, std::uint32_t, const GatherIo& io) const {
  passes_.recordPlan(list, io, shared::kPlanList, command_);
  passes_.recordGather(list, io, command_);
}

}  // namespace palpate
