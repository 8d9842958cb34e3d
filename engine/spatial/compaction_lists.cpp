#include "engine/spatial/compaction_lists.hpp"

#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

PipelineOptions pipeline() {
  return {.workgroupSize = shared::kUpdateWorkgroup, .pushBytes = sizeof(shared::CompactionArgs)};
}

}  // namespace

CompactionLists::CompactionLists(Device& device, const SpatialHash& hash, const LiveCloud& live,
                                 const HashUpdate& update, std::uint32_t bucketsEach, std::uint32_t mostDirty)
    : device_(device),
      slicePass_(device, shader_code::spatial_compact_slice, pipeline()),
      plan_(device, shader_code::spatial_compact_plan, pipeline()),
      again_(device, shader_code::spatial_compact_again, pipeline()),
      finish_(device, shader_code::spatial_compact_finish, pipeline()),
      state_(Buffer::of<shared::HashCompaction>(device, 1, Memory::device, "compaction state")),
      report_(Buffer::of<shared::HashCompaction>(device, 1, Memory::readback, "compaction report")),
      sliceOf_(Buffer::of<shared::CompactionSlice>(device, 1, Memory::upload, "compaction slice")) {
  report_.mapped<shared::HashCompaction>()[0] = {};
  const Sources sources{hash, live, update, bucketsEach, mostDirty};
  record(sources, live.front(), live.back());
  record(sources, live.back(), live.front());
  warmUp(live.parity());
}

// Some drivers compile a pass at its first run, which no tick should wait for: here all run once without work.
void CompactionLists::warmUp(std::uint32_t parity) {
  device_.latencyQueue().run(begin(parity));
  device_.backgroundQueue().run(slice(parity, {.slots = UVec2(0), .buckets = UVec2(0)}));
  upload(device_, state_, std::vector<shared::HashCompaction>{{.failed = shared::kCompactionNoSlots}});
  device_.latencyQueue().run(end(parity));
}

void CompactionLists::record(const Sources& sources, const LiveCloud::Half& from, const LiveCloud::Half& to) {
  const auto recorded = [&](const Queue& queue, const char* name, auto&& record) {
    auto list = std::make_unique<CommandList>(device_, queue, name, CommandList::Timing::sections);
    list->begin();
    {
      const auto section = list->section("compaction");
      record(*list);
    }
    list->end();
    return list;
  };
  const shared::CloudView cloud = sources.hash.view(from, sources.live.slots());
  const shared::HashUpdateArgs update = sources.update.args(cloud, to.parity);
  const shared::CompactionArgs args{.from = update.cloud,
                                    .positions = to.positions.address(),
                                    .normals = to.normals.address(),
                                    .ranges = sources.hash.ranges(to).address(),
                                    .capacities = update.capacities,
                                    .state = state_.address(),
                                    .slice = sliceOf_.address(),
                                    .update = update.update,
                                    .dirty = update.dirty};
  begin_[from.parity] = recorded(device_.latencyQueue(), "begin compaction", [&](CommandList& list) {
    sources.update.recordNoting(list, sources.mostDirty);
    list.fill(state_, 0, state_.bytes());
  });
  slice_[from.parity] = recorded(device_.backgroundQueue(), "compaction slice",
                                 [&](CommandList& list) { list.dispatch(slicePass_, sources.bucketsEach, args); });
  end_[from.parity] = recorded(device_.latencyQueue(), "end compaction", [&](CommandList& list) {
    list.dispatch(plan_, shared::kPlanGroups * shared::kUpdateWorkgroup, args);
    list.dispatchIndirect(again_, state_, args, offsetof(shared::HashCompaction, againGroups));
    list.dispatch(finish_, 1, args);
    list.copy(state_, report_, sizeof(shared::HashCompaction));
    sources.update.recordReport(list);
  });
}

}  // namespace palpate
