// Whether what takes long is to end before its time. Long loops ask it; whoever began the job says where it may be cut.
#pragma once

#include <atomic>
#include <utility>

#include "engine/core/error.hpp"

namespace palpate {

/// A job was asked to stop, and has.
class Stopped : public Error {
 public:
  using Error::Error;
};

/// What the job of a thread is stopped by; its helpers take it over.
struct JobStop {
  const std::atomic<bool>* flag = nullptr;  ///< null: nothing stops it
  bool mayCut = false;                      ///< wherever a loop asks; else only where whoever began it asks for it
};

inline thread_local JobStop jobStop;  // of this thread

/// While it lives, this thread has that sign.
class JobStopScope {
 public:
  explicit JobStopScope(const JobStop& sign) : before_(std::exchange(jobStop, sign)) {}
  ~JobStopScope() { jobStop = before_; }
  JobStopScope(const JobStopScope&) = delete;
  JobStopScope& operator=(const JobStopScope&) = delete;

  /// What is under way may be cut wherever a loop asks: nothing is left of it then.
  static JobStop cutting() { return {jobStop.flag, true}; }
  /// What is under way is done as a whole.
  static JobStop whole() { return {jobStop.flag, false}; }

 private:
  JobStop before_;
};

/// Whether somebody wants the job of this thread to end.
inline bool isStopWanted(const JobStop& sign = jobStop) noexcept {
  return sign.flag && sign.flag->load(std::memory_order_relaxed);
}
/// For long loops: throws Stopped where they may be cut and somebody wants it.
inline void throwIfStopWanted(const JobStop& sign = jobStop) {
  if (sign.mayCut && isStopWanted(sign)) throw Stopped("stopped");
}

}  // namespace palpate
