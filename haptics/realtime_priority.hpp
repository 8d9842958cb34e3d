#pragma once

#include <cstdint>

namespace palpate {

/// Asks for the scheduling of work that cannot wait and for the finest timer, for the calling thread, and gives its old
/// scheduling back when it goes. Destroy it on the thread that made it.
class RealtimePriority {
 public:
  RealtimePriority() noexcept;
  ~RealtimePriority();
  RealtimePriority(const RealtimePriority&) = delete;
  RealtimePriority& operator=(const RealtimePriority&) = delete;

  /// False when the machine does not let this user have it; ticks then come as the normal scheduler likes.
  bool granted() const { return granted_; }

  /// How late a thread that has it is woken, as a rule.
  static std::int64_t wakesWithin_ns() noexcept;

 private:
  // As it was before.
  struct Scheduling {
    int policy = 0, priority = 0;
    int slack_ns = 0;      ///< how late the system may wake the thread to save wake-ups
    void* task = nullptr;  ///< as which it is known to the system's own scheduler of sound
  };
  Scheduling before_;
  bool granted_ = false;
};

}  // namespace palpate
