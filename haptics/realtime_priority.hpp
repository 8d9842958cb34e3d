#pragma once

#include <cstdint>

namespace palpate {

/// Requests real-time scheduling and the finest timer for the calling thread; the destructor restores its former
/// scheduling. Destroy it on the thread that created it.
class RealtimePriority {
 public:
  RealtimePriority() noexcept;
  ~RealtimePriority();
  RealtimePriority(const RealtimePriority&) = delete;
  RealtimePriority& operator=(const RealtimePriority&) = delete;

  /// False if the machine does not grant it to this user; ticks then depend on the normal scheduler.
  bool granted() const { return granted_; }

  /// The command that lets this user have it; empty if there is none.
  static const char* command() noexcept;

  /// Typical wake-up latency of a thread that has it.
  static std::int64_t wakesWithin_ns() noexcept;

 private:
  // The former scheduling.
  struct Scheduling {
    int policy = 0, priority = 0;
    int slack_ns = 0;      ///< how late the system may wake the thread to save wake-ups
    void* task = nullptr;  ///< handle of the system's multimedia scheduler
  };
  Scheduling before_;
  bool granted_ = false;
};

}  // namespace palpate
