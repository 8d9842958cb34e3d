#include "engine/edit/refit_normals.hpp"

#include <algorithm>

#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

namespace {
constexpr std::uint32_t kWorkgroup = 256;
}

RefitNormals::RefitNormals(Device& device, std::uint32_t points)
    : pointsPerGroup_(kWorkgroup / device.subgroupSize()),
      largestAxis_(std::min(device.properties().limits.maxComputeWorkGroupCount[0],
                            device.properties().limits.maxComputeWorkGroupCount[1])),
      collect_(device, shader_code::edit_collect_moved, {.pushBytes = sizeof(shared::CollectMovedArgs)}),
      plan_(device, shader_code::edit_plan_refit, {.workgroupSize = 32, .pushBytes = sizeof(shared::PlanRefitArgs)}),
      refit_(device, shader_code::edit_refit_normals,
             {.workgroupSize = kWorkgroup, .pushBytes = sizeof(shared::RefitNormalsArgs)}),
      moved_(Buffer::of<std::uint32_t>(device, points, Memory::device, "moved points")),
      movedCount_(Buffer::of<std::uint32_t>(device, 1, Memory::device, "moved count")),
      groups_(Buffer::of<std::uint32_t>(device, 3, Memory::device, "refit groups")) {}

void RefitNormals::record(CommandList& list, const shared::CloudView& cloud, const EditLog& log, double radius) const {
  const auto section = list.section("refit normals");
  list.fill(movedCount_, 0, movedCount_.bytes());
  list.dispatch(collect_, cloud.slots,
                shared::CollectMovedArgs{.normals = cloud.normals,
                                         .moved = moved_.address(),
                                         .movedCount = movedCount_.address(),
                                         .count = cloud.slots,
                                         .unused = 0});
  list.dispatch(plan_, 1,
                shared::PlanRefitArgs{.movedCount = movedCount_.address(),
                                      .groups = groups_.address(),
                                      .pointsPerGroup = pointsPerGroup_,
                                      .largestAxis = largestAxis_});
  list.dispatchIndirect(refit_, groups_,
                        shared::RefitNormalsArgs{.cloud = cloud,
                                                 .moved = moved_.address(),
                                                 .movedCount = movedCount_.address(),
                                                 .entries = log.entries(),
                                                 .head = log.head(),
                                                 .capacityMask = static_cast<std::uint32_t>(log.capacity() - 1),
                                                 .radius = static_cast<float>(radius)});
}

}  // namespace palpate
