// What time it is for a session in real time, and how its servo thread waits for a tick.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>

namespace palpate {

class SessionClock {
 public:
  virtual ~SessionClock() = default;
  virtual std::int64_t now_ns() const noexcept = 0;
  /// For the thread that ticks.
  virtual void waitUntil_ns(std::int64_t time_ns) noexcept = 0;
};

/// The machine's, which never goes back. It has no state: one serves everybody.
SessionClock& machineClock() noexcept;

/// Stands still while a tick runs, however long that takes, and goes on while the session waits for the next one: at
/// once where it is let go, as it is at first, and else as far as another thread says. So a session does the same on
/// the slowest machine. One session at a time.
class SteppedClock final : public SessionClock {
 public:
  std::int64_t now_ns() const noexcept override;
  void waitUntil_ns(std::int64_t time_ns) noexcept override;

  /// A session begins to tick, held where the clock was held last; it has left when it ticks no more.
  void hold() noexcept;
  void leave() noexcept;
  /// Nobody is held any more, for a session that is to end.
  void letGo() noexcept;
  /// Lets the session go on to `time_s`; returns when it has done all ticks until then, or has left.
  void goOnTo(double time_s) noexcept;

 private:
  static constexpr std::int64_t kNotWaiting = -1;

  mutable std::mutex guard_;
  std::condition_variable go_, arrived_;
  std::int64_t now_ns_ = 0, limit_ns_ = 0, awaited_ns_ = kNotWaiting;
  bool held_ = false, ticks_ = false;
};

}  // namespace palpate
