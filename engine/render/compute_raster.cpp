#include "engine/render/compute_raster.hpp"

#include <algorithm>

#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

// Small workgroups: a workgroup lasts as long as its largest splat, and the touch side may be waiting for its place on
// the GPU.
constexpr std::uint32_t kWorkgroup = 64;
// Picking reads every point, but most are rejected quickly.
constexpr std::uint32_t kPickSlice = (1 << 21) / shared::kPickPoints;

ComputePipeline splatPass(Device& device, const ShaderCode& code, bool large) {
  return {device, code, {.workgroupSize = kWorkgroup, .pushBytes = sizeof(shared::SplatArgs), .constants = {large}}};
}

const ShaderCode& attributesCode(const Device& device, bool wideAtomics) {
  return wideAtomics && device.hasWideAtomics() ? shader_code::render_splat_attributes_wide
                                                : shader_code::render_splat_attributes;
}

}  // namespace

ComputeRaster::ComputeRaster(Device& device, bool wideAtomics)
    : device_(device),
      pick_(device, shader_code::render_splat_pick,
            {.workgroupSize = std::min(shared::kPickWorkgroup, device.widestWorkgroup() / 32 * 32),
             .pushBytes = sizeof(shared::SplatArgs),
             .sliceThreads = kPickSlice}),
      plan_(device, shader_code::render_splat_plan, {.workgroupSize = 32, .pushBytes = sizeof(shared::SplatPlanArgs)}),
      smallDepth_(splatPass(device, shader_code::render_splat_depth, false)),
      largeDepth_(splatPass(device, shader_code::render_splat_depth, true)),
      smallAttributes_(splatPass(device, attributesCode(device, wideAtomics), false)),
      largeAttributes_(splatPass(device, attributesCode(device, wideAtomics), true)),
      counts_(Buffer::of<shared::SplatCounts>(device, 1, Memory::device, "splat counts")),
      shares_(Buffer::of<UVec2>(device, shared::kMaxShares, Memory::device, "splat shares")) {}

void ComputeRaster::record(CommandList& list, const DrawnCloud& cloud, const RasterTarget& target) const {
  const std::uint32_t turns = device_.hasUrgentWork() ? shared::kSplatTurns : 1;
  shared::SplatArgs args{.counts = counts_.address(),
                         .picked = cloud.picked().address(),
                         .shares = shares_.address(),
                         .positions = cloud.positions().address(),
                         .normals = cloud.normals().address(),
                         .colors = cloud.colors().address(),
                         .clips = cloud.shapes().clips.address(),
                         .widths = cloud.shapes().widths.address(),
                         .depth = target.depth,
                         .normalSums = target.normalSums,
                         .colorSums = target.colorSums};
  const auto walk = [&](const ComputePipeline& small, const ComputePipeline& large) {
    for (args.turn = 0; args.turn < turns; ++args.turn) {
      const auto overlap = list.independent();
      list.dispatchIndirect(small, counts_, args, offsetof(shared::SplatCounts, smallGroups));
      list.dispatchIndirect(large, counts_, args, offsetof(shared::SplatCounts, largeGroups));
    }
  };
  const auto section = list.section("splat");
  list.fill(counts_, 0, counts_.bytes());
  list.dispatch(pick_, (std::uint64_t{cloud.count()} + shared::kPickPoints - 1) / shared::kPickPoints, args);
  list.dispatch(plan_, 1,
                shared::SplatPlanArgs{.counts = counts_.address(),
                                      .smallsPerGroup = kWorkgroup,
                                      .largesPerGroup = kWorkgroup / shared::kSplatWalkers,
                                      .turns = turns,
                                      .unused = 0});
  walk(smallDepth_, largeDepth_);
  walk(smallAttributes_, largeAttributes_);
}

shared::SplatCounts ComputeRaster::readCounts() const {
  return download<shared::SplatCounts>(device_, device_.throughputQueue(), counts_, 1).front();
}

}  // namespace palpate
