#include "engine/study/bucket_passes.hpp"

#include "shaders/study.hpp"

namespace palpate {

BucketPasses::BucketPasses(Device& device, std::uint32_t cells)
    : cells_(cells),
      plan_(device, shader_code::contact_gather_plan,
            {.workgroupSize = shared::kContactWorkgroup, .pushBytes = sizeof(shared::GatherPlanArgs)}),
      gather_(device, shader_code::contact_gather_buckets,
              {.workgroupSize = shared::kGatherChunk, .pushBytes = sizeof(shared::GatherBucketsArgs)}),
      planned_(Buffer::of<shared::GatherCell>(device, cells, Memory::device, "gather cells")) {}

std::uint64_t BucketPasses::slots() const {
  // Each cell may leave its last chunk almost empty.
  return std::uint64_t{cells_} * shared::kGatherChunk +
         std::uint64_t{gatherRounds(cells_)} * shared::kPatchRoundCandidates;
}

void BucketPasses::recordPlan(CommandList& list, const GatherIo& io, std::uint32_t plan, const Buffer& launch) const {
  list.dispatch(plan_, shared::kContactWorkgroup,
                shared::GatherPlanArgs{.cloud = io.cloud,
                                       .pose = io.pose,
                                       .state = io.state,
                                       .gathered = io.patch,
                                       .cells = planned_.address(),
                                       .launch = launch.address(),
                                       .radius = io.radius,
                                       .mostCells = cells_,
                                       .plan = plan,
                                       .unused = 0});
}

void BucketPasses::recordGather(CommandList& list, const GatherIo& io, const Buffer& groups, std::uint64_t offset,
                                std::uint32_t firstCell) const {
  list.dispatchIndirect(gather_, groups,
                        shared::GatherBucketsArgs{.cloud = io.cloud,
                                                  .pose = io.pose,
                                                  .gathered = io.patch,
                                                  .cells = planned_.address(),
                                                  .firstCell = firstCell,
                                                  .radius = io.radius},
                        offset);
}

}  // namespace palpate
