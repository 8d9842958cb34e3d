#include "engine/touch/live_index.hpp"

#include <algorithm>

#include "engine/gpu/device.hpp"

namespace palpate {

LiveIndex::LiveIndex(Device& device, const PointCloud& cloud, const LiveIndexOptions& options)
    : device_(device),
      live_(device, cloud, options.spareSlots, nullptr, options.colored),
      hash_(device, options.grid, live_.slots(), options.sort, options.bucketOrder, options.slots),
      buildTime_us_(hash_.build(live_)) {}

void LiveIndex::follow(const HashUpdate& update, const CompactionOptions& options) {
  update_ = &update;
  compaction_.emplace(device_, hash_, live_, update, options);
}

void LiveIndex::built() {
  live_.flip();
  ++work_.built;
}

void LiveIndex::readReport() {
  if (compaction_) compactionDue_ = compaction_->isDue(update_->report());
}

void LiveIndex::compactFurther(bool realtime) {
  if (!compaction_) return;
  if (!realtime) {
    compaction_->settle();
    if (compactionDue_) noteCompaction(compaction_->run(), nullptr);
    return;
  }
  compaction_->advance();
  if (compaction_->stage() == HashCompaction::Stage::copied)
    compaction_->end();
  else if (compaction_->isIdle() && compactionDue_)
    compaction_->begin();
}

void LiveIndex::collectCompaction(const Stopwatch* sinceAsked) {
  if (!compaction_ || compaction_->stage() != HashCompaction::Stage::ending) return;
  device_.latencyQueue().wait(compaction_->endTicket(), device_.defaultWait());
  noteCompaction(compaction_->collect(), sinceAsked);
}

void LiveIndex::noteCompaction(bool completed, const Stopwatch* sinceAsked) {
  readReport();
  const double end_us = sinceAsked ? sinceAsked->elapsed_us() : compaction_->endTime_us();
  compactions_.longestEnd_us = std::max(compactions_.longestEnd_us, end_us);
  if (!completed) return;
  live_.flip();
  ++compactions_.completed;
}

bool LiveIndex::mayBuild(bool realtime) {
  if (!compaction_) return true;
  if (realtime)
    compaction_->abandon();
  else
    compaction_->settle();
  return compaction_->isIdle();
}

void LiveIndex::buildNow(const std::function<void(CommandList&, SortMethod)>& record) {
  mayBuild(false);
  for (SortMethod used = hash_.sort();; used = hash_.fallback()) {
    CommandList list(device_, device_.latencyQueue(), "build");
    list.begin();
    record(list, used);
    list.end();
    device_.latencyQueue().run(list);
    ++work_.built;
    if (used == hash_.sort()) break;  // otherwise a bucket overflowed, and the order of its points is undefined
  }
  live_.flip();
}

}  // namespace palpate
