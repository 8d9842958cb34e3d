#include "engine/contact/contact_step.hpp"

#include <algorithm>
#include <cmath>

#include "engine/gpu/transfer.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

std::uint64_t spilledPoints(std::uint32_t points) {
  const std::uint32_t most = std::min(points, shared::kMostPatchPoints);
  return most - std::min(most, shared::kSharedPatch);
}

}  // namespace

double smallestCell(double radius) {
  // A gather spans 2 (1 + slack) radii, and one cell more for its place within the cells.
  const double cellsPerSide = std::floor(std::cbrt(shared::kPatchMaxCells)) - 1.0;
  return 1.01 * 2.0 * (1.0 + static_cast<double>(shared::kPatchSlack)) * radius / cellsPerSide;
}

ContactStep::ContactStep(Device& device, double radius, std::uint32_t points)
    : radius_(radius),
      step_(device, shader_code::contact_contact_step,
            {.workgroupSize = shared::kContactWorkgroup, .pushBytes = sizeof(shared::ContactStepArgs)}),
      pose_(Buffer::of<shared::ContactPose>(device, 1, Memory::upload, "contact pose")),
      state_(Buffer::of<shared::ContactState>(device, 1, Memory::device, "contact state")),
      sample_(Buffer::of<shared::ContactSample>(device, 1, Memory::readback, "contact sample")),
      spill_(Buffer::of<Vec4>(device, 2 * spilledPoints(points), Memory::device, "patch spill")) {
  PALPATE_CHECK_LT(0.0, radius);
  upload(device, state_, std::vector<shared::ContactState>(1));
  pose() = {};
}

void ContactStep::record(CommandList& list, const shared::CloudView& cloud, DeviceAddress logHead) const {
  PALPATE_CHECK_LE(smallestCell(radius_) * cloud.grid.inverseCell, 1.0 + 1e-5);
  const auto section = list.section("contact");
  list.dispatch(step_, shared::kContactWorkgroup,
                shared::ContactStepArgs{.cloud = cloud,
                                        .pose = pose_.address(),
                                        .state = state_.address(),
                                        .result = sample_.address(),
                                        .spill = spill_.address(),
                                        .logHead = logHead,
                                        .radius = static_cast<float>(radius_),
                                        .unused = 0});
}

}  // namespace palpate
