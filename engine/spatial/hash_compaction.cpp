#include "engine/spatial/hash_compaction.hpp"

#include <algorithm>

#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"

namespace palpate {

namespace {

// Buckets per slice; each contains a few points. On a queue shared with touch a slice takes a part of a tick; on a
// separate queue its workgroups are short, and larger submissions finish sooner overall.
constexpr std::uint32_t kSharedSlice = 1 << 11, kOwnSlice = 1 << 17;

std::uint32_t bucketsPerSlice(const Device& device, const CompactionOptions& options) {
  if (options.bucketsPerSlice > 0) return options.bucketsPerSlice;
  return device.roles().backgroundShares() ? kSharedSlice : kOwnSlice;
}

}  // namespace

HashCompaction::HashCompaction(Device& device, const SpatialHash& hash, const LiveCloud& live, const HashUpdate& update,
                               const CompactionOptions& options)
    : device_(device),
      live_(live),
      update_(update),
      slices_(live.slots(), hash.grid().bucketMask + 1, bucketsPerSlice(device, options)),
      lists_(device, hash, live, update, slices_.bucketsEach(), options.mostDirty),
      base_(live.count()) {}

HashCompaction::~HashCompaction() {
  try {
    if (on_) on_->wait(ticket_);  // covers all earlier submissions: each waits for the previous one
  } catch (const GpuError&) {     // the device is lost, so nothing runs on it
  }
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
  slices_.restart();
  submit(device_.latencyQueue(), lists_.begin(parity_));
  stage_ = Stage::noting;
}

void HashCompaction::submit(Queue& queue, const CommandList& list) {
  on_ = &queue;
  ticket_ = queue.submit(list);
}

void HashCompaction::submitSlice() {
  submit(device_.backgroundQueue(), lists_.slice(parity_, slices_.next()));
  stage_ = Stage::copying;
}

void HashCompaction::advance() {
  const bool runs = stage_ == Stage::noting || stage_ == Stage::copying || stage_ == Stage::abandoning;
  // The fence of the list after the edits guarantees that the background queue sees their writes. The last slice's
  // fence does the same for the background's writes.
  if (!runs || !on_->isDone(ticket_)) return;
  if (stage_ == Stage::abandoning)
    stage_ = Stage::idle;
  else if (!slices_.areDone())
    submitSlice();
  else
    stage_ = Stage::copied;
}

void HashCompaction::end() {
  PALPATE_CHECK(stage_ == Stage::copied);
  PALPATE_CHECK_EQ(parity_, live_.parity());
  submit(device_.latencyQueue(), lists_.end(parity_));
  stage_ = Stage::ending;
}

bool HashCompaction::collect() {
  PALPATE_CHECK(stage_ == Stage::ending);
  stage_ = Stage::idle;
  const bool completed = report().completed != 0;
  // If the points did not fit, a retry is useless until more slots are used or the index was rebuilt.
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
