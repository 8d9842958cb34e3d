// The clock of a session in real time, and how its servo thread waits for a tick.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>

namespace palpate {

class SessionClock {
 public:
  virtual ~SessionClock() = default;
  virtual std::int64_t now_ns() const noexcept = 0;
  /// For the thread that ticks.
  virtual void waitUntil_ns(std::int64_t time_ns) noexcept = 0;
};

/// The machine's monotonic clock. Stateless: one instance serves all.
SessionClock& machineClock() noexcept;

/// Is constant during a tick, however long that takes, and advances while the session waits for the next one: at once
/// while it is let go, as it is initially, otherwise as far as another thread permits. So a session does the same on
/// the slowest machine. One session at a time.
class SteppedClock final : public SessionClock {
 public:
  std::int64_t now_ns() const noexcept override;
  void waitUntil_ns(std::int64_t time_ns) noexcept override;

  /// A session starts ticking, held where the clock was held last; leave(): it no longer ticks.
  void hold() noexcept;
  void leave() noexcept;
  /// No session is held any more, so that it can end.
  void letGo() noexcept;
  /// Lets the session advance to `time_s`; returns when it has done all ticks until then, or has left.
  void goOnTo(double time_s) noexcept;
  /// What the session's thread does at each wake() while it waits for a tick; empty: nothing.
  void serve(std::function<void()> between);
  void wake() noexcept;
  /// The session comes too late for the ticks until `time_s`.
  void passTo(double time_s) noexcept;

 private:
  static constexpr std::int64_t kNotWaiting = -1;

  mutable std::mutex guard_;
  std::condition_variable go_, arrived_;
  std::int64_t now_ns_ = 0, limit_ns_ = 0, awaited_ns_ = kNotWaiting;
  bool held_ = false, ticks_ = false, woken_ = false;
  std::function<void()> between_;
};

}  // namespace palpate
