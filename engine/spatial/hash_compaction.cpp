#include "engine/spatial/hash_compaction.hpp"

#include <algorithm>

#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

// Buckets of a slice, each of which holds a few points. On a queue that touch shares a slice takes a part of a tick; on
// one of its own its workgroups are short, and more of them a submission end sooner.
constexpr std::uint32_t kSharedSlice = 1 << 11, kOwnSlice = 1 << 17;
// Slots that a slice empties for each bucket that it may copy.
constexpr std::uint32_t kSlotsPerBucket = 8;

PipelineOptions pipeline(std::uint32_t pushBytes) {
  return {.workgroupSize = shared::kUpdateWorkgroup, .pushBytes = pushBytes};
}

std::uint32_t slicesOf(std::uint32_t count, std::uint32_t each) { return (count + each - 1) / each; }

}  // namespace

HashCompaction::HashCompaction(Device& device, const SpatialHash& hash, const LiveCloud& live, const HashUpdate& update,
                               const CompactionOptions& options)
    : device_(device),
      hash_(hash),
      live_(live),
      update_(update),
      slicePass_(device, shader_code::spatial_compact_slice, pipeline(sizeof(shared::CompactionArgs))),
      plan_(device, shader_code::spatial_compact_plan, pipeline(sizeof(shared::CompactionArgs))),
      again_(device, shader_code::spatial_compact_again, pipeline(sizeof(shared::CompactionArgs))),
      finish_(device, shader_code::spatial_compact_finish, pipeline(sizeof(shared::CompactionArgs))),
      state_(Buffer::of<shared::HashCompaction>(device, 1, Memory::device, "compaction state")),
      report_(Buffer::of<shared::HashCompaction>(device, 1, Memory::readback, "compaction report")),
      sliceOf_(Buffer::of<shared::CompactionSlice>(device, 1, Memory::upload, "compaction slice")),
      bucketsPerSlice_(options.bucketsPerSlice > 0         ? options.bucketsPerSlice
                       : device.roles().backgroundShares() ? kSharedSlice
                                                           : kOwnSlice),
      slotsPerSlice_(kSlotsPerBucket * bucketsPerSlice_),
      clears_(slicesOf(live.slots(), slotsPerSlice_)),
      copies_(slicesOf(hash.grid().bucketMask + 1, bucketsPerSlice_)),
      base_(live.count()) {
  const std::uint32_t parity = live.parity();
  report_.mapped<shared::HashCompaction>()[0] = {};
  record(parity, live.side(), live.otherSide(), options.mostDirty);
  record(1 - parity, live.otherSide(), live.side(), options.mostDirty);
  warmUp();
}

HashCompaction::~HashCompaction() {
  try {
    if (on_) on_->wait(ticket_);  // all before it has ended: each submission waits for the last one
  } catch (const GpuError&) {     // the device is lost: nothing runs on it any more
  }
}

// Some drivers compile a pass when it first runs, which no tick should wait for: here all run for nothing.
void HashCompaction::warmUp() {
  sliceOf_.mapped<shared::CompactionSlice>()[0] = {.slots = UVec2(0), .buckets = UVec2(0)};
  device_.touch().run(*begin_[live_.parity()]);
  device_.background().run(*slice_[live_.parity()]);
  upload(device_, state_, std::vector<shared::HashCompaction>{{.failed = shared::kCompactionNoSlots}});
  device_.touch().run(*end_[live_.parity()]);
}

void HashCompaction::record(std::uint32_t parity, const LiveCloud::Side& from, const LiveCloud::Side& to,
                            std::uint32_t mostDirty) {
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
  const shared::HashUpdateArgs update = update_.args(hash_.view(from, live_.slots()), to.parity);
  const shared::CompactionArgs args{.from = update.cloud,
                                    .positions = to.positions.address(),
                                    .normals = to.normals.address(),
                                    .ranges = hash_.ranges(to).address(),
                                    .capacities = update.capacities,
                                    .state = state_.address(),
                                    .slice = sliceOf_.address(),
                                    .update = update.update,
                                    .dirty = update.dirty};
  begin_[parity] = recorded(device_.touch(), "begin compaction", [&](CommandList& list) {
    update_.recordNoting(list, mostDirty);
    list.fill(state_, 0, state_.bytes());
  });
  slice_[parity] = recorded(device_.background(), "compaction slice",
                            [&](CommandList& list) { list.dispatch(slicePass_, bucketsPerSlice_, args); });
  end_[parity] = recorded(device_.touch(), "end compaction", [&](CommandList& list) {
    list.dispatch(plan_, shared::kPlanGroups * shared::kUpdateWorkgroup, args);
    list.dispatchIndirect(again_, state_, args, offsetof(shared::HashCompaction, againGroups));
    list.dispatch(finish_, 1, args);
    list.copy(state_, report_, sizeof(shared::HashCompaction));
    update_.recordReport(list);
  });
}

bool HashCompaction::isDue(const shared::HashUpdate& report) {
  base_ = std::min(base_, report.head);
  const std::uint32_t free = live_.slots() - base_, used = report.head - base_;
  const std::uint32_t gaps = report.head - std::min(report.head, report.points);
  constexpr std::uint32_t kWorthwhile = 4;
  return used > free / 2 && gaps > free / kWorthwhile;
}

void HashCompaction::begin() {
  PALPATE_CHECK(stage_ == Stage::idle);
  parity_ = live_.parity();
  next_ = 0;
  submit(device_.touch(), *begin_[parity_]);
  stage_ = Stage::noting;
}

void HashCompaction::submit(Queue& queue, const CommandList& list) {
  on_ = &queue;
  ticket_ = queue.submit(list);
}

void HashCompaction::submitSlice() {
  const std::uint32_t buckets = hash_.grid().bucketMask + 1, slots = live_.slots();
  // The slots are emptied first, since a slice may copy to any of them.
  shared::CompactionSlice slice{.slots = {}, .buckets = {}};
  if (next_ < clears_)
    slice.slots = {next_ * slotsPerSlice_, std::min(slots, (next_ + 1) * slotsPerSlice_)};
  else
    slice.buckets = {(next_ - clears_) * bucketsPerSlice_, std::min(buckets, (next_ - clears_ + 1) * bucketsPerSlice_)};
  sliceOf_.mapped<shared::CompactionSlice>()[0] = slice;
  ++next_;
  submit(device_.background(), *slice_[parity_]);
  stage_ = Stage::copying;
}

void HashCompaction::advance() {
  const bool runs = stage_ == Stage::noting || stage_ == Stage::copying || stage_ == Stage::abandoning;
  // The background must find what edits have written so far: the fence of the list behind them says that it is there.
  // So does the last slice's fence for what the background has written.
  if (!runs || !on_->isDone(ticket_)) return;
  if (stage_ == Stage::abandoning)
    stage_ = Stage::idle;
  else if (next_ < slices())
    submitSlice();
  else
    stage_ = Stage::copied;
}

void HashCompaction::end() {
  PALPATE_CHECK(stage_ == Stage::copied);
  PALPATE_CHECK_EQ(parity_, live_.parity());
  submit(device_.touch(), *end_[parity_]);
  stage_ = Stage::ending;
}

bool HashCompaction::collect() {
  PALPATE_CHECK(stage_ == Stage::ending);
  stage_ = Stage::idle;
  const bool completed = report().completed != 0;
  // Where the points did not fit, another try is in vain until more slots are used or a build has been.
  if (completed || report().failed & shared::kCompactionNoSlots) base_ = update_.report().head;
  return completed;
}

void HashCompaction::abandon() {
  PALPATE_CHECK(stage_ != Stage::ending);
  if (stage_ == Stage::idle) return;
  stage_ = stage_ == Stage::copied ? Stage::idle : Stage::abandoning;
  advance();
}

void HashCompaction::settle() {
  abandon();
  if (stage_ == Stage::abandoning) on_->wait(ticket_);
  advance();
}

bool HashCompaction::run() {
  begin();
  while (stage_ != Stage::copied) {
    on_->wait(ticket_);
    advance();
  }
  end();
  on_->wait(ticket_);
  return collect();
}

}  // namespace palpate
