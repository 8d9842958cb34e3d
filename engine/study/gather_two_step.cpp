#include "engine/study/gather_two_step.hpp"

namespace palpate {

GatherTwoStep::GatherTwoStep(Device& device, std::uint32_t cells)
    : passes_(device, cells),
      counts_(Buffer::of<std::uint32_t>(device, 2, Memory::readback, "gather counts")),
      command_(Buffer::of<VkDispatchIndirectCommand>(device, 1, Memory::upload, "gather command")) {}

void GatherTwoStep::record(CommandList& list, std::uint32_t submission, const GatherIo& io) const {
  if (submission == 0)
    passes_.recordPlan(list, io, shared::kPlanCounts, counts_);
  else
    passes_.recordGather(list, io, command_);
}

void GatherTwoStep::resume() const {
  const auto counts = counts_.mapped<const std::uint32_t>();
  const std::uint32_t buckets = counts[0], largest = counts[1];
  command_.mapped<VkDispatchIndirectCommand>()[0] = {
      .x = (largest + shared::kGatherChunk - 1) / shared::kGatherChunk, .y = buckets, .z = 1};
}

}  // namespace palpate
