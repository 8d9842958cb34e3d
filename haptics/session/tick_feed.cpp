#include "haptics/session/tick_feed.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/processor.hpp"

namespace palpate {

void TickFeed::ticked(const TraceRow& row, const DeviceState& /*device*/) noexcept {
  core_.store(currentCore(), std::memory_order_relaxed);
  if (std::exchange(leftOut_, false) || isFull()) return;
  const std::uint64_t added = added_.load(std::memory_order_relaxed);
  rowOf(added, 0) = row;
  added_.store(added + 1, std::memory_order_release);
}

// A tick is added with all its hands or not at all.
void TickFeed::tickedToo(std::size_t hand, const TraceRow& row) noexcept {
  if (hand >= hands_ || leftOut_) return;
  leftOut_ = isFull();
  if (!leftOut_) rowOf(added_.load(std::memory_order_relaxed), hand) = row;
}

bool TickFeed::isFull() const noexcept {
  return added_.load(std::memory_order_relaxed) - taken_.load(std::memory_order_acquire) >= kRing;
}

void TickFeed::take(std::vector<TraceRow>& rows) {
  const std::uint64_t added = added_.load(std::memory_order_acquire);
  std::uint64_t taken = taken_.load(std::memory_order_relaxed);
  for (; taken < added; ++taken)
    for (std::size_t hand = 0; hand < hands_; ++hand) rows.push_back(rowOf(taken, hand));
  taken_.store(taken, std::memory_order_release);
}

double RecentTicks::onTime_percent() const {
  if (ticks_ == 0) return 100;
  const double share = 1 - static_cast<double>(missed_) / static_cast<double>(ticks_);
  return std::max(0.0, std::floor(1000 * share) / 10);
}

void RecentTicks::add(const std::vector<TraceRow>& rows) {
  for (const TraceRow& row : rows) {
    ++ticks_;
    missed_ += row.missed;
    step_us_.add(row.step_us);
    rows_.push_back(row);
    if (rows_.size() > kKept) rows_.pop_front();
  }
}

}  // namespace palpate
