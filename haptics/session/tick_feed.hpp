#pragma once

#include <atomic>
#include <deque>
#include <vector>

#include "haptics/servo_loop.hpp"

namespace palpate {

/// Passes the ticks from the servo thread to the thread that displays them; the former is never blocked.
class TickFeed final : public TickRecorder {
 public:
  explicit TickFeed(std::size_t hands = 1) : hands_(hands), ring_(kRing * hands) {}

  /// On the servo thread.
  void tickedToo(std::size_t hand, const TraceRow& row) noexcept override;
  void ticked(const TraceRow& row, const DeviceState& device) noexcept override;

  /// Appends the rows since the last call, ordered by tick, then by hand. For one thread.
  void take(std::vector<TraceRow>& rows);
  /// CPU core of the last tick; negative before the first.
  int core() const { return core_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::uint64_t kRing = 1 << 15;  // half a minute at 1 kHz; further rows are dropped

  TraceRow& rowOf(std::uint64_t tick, std::size_t hand) noexcept { return ring_[tick % kRing * hands_ + hand]; }
  bool isFull() const noexcept;

  std::size_t hands_;
  bool leftOut_ = false;  // the present tick is dropped, because the ring is full
  std::vector<TraceRow> ring_;
  std::atomic<std::uint64_t> added_ = 0, taken_ = 0;
  std::atomic<int> core_ = -1;
};

/// Statistics and curves of the ticks so far, for display.
class RecentTicks {
 public:
  /// Maximum number of rows kept for curves and CSV: the last ones.
  static constexpr std::size_t kKept = 60'000;

  void add(const std::vector<TraceRow>& rows);

  const std::deque<TraceRow>& rows() const { return rows_; }
  std::uint64_t ticks() const { return ticks_; }
  std::uint64_t missed() const { return missed_; }
  /// Share of the ticks that were on time, rounded down to a tenth: 100 only if none was late.
  double onTime_percent() const;
  const TickHistogram& step_us() const { return step_us_; }
  /// Whether the last row, if there is one, is of a tick in contact.
  bool inContact() const { return !rows_.empty() && rows_.back().contact; }

 private:
  std::deque<TraceRow> rows_;
  std::uint64_t ticks_ = 0, missed_ = 0;
  TickHistogram step_us_;
};

}  // namespace palpate
