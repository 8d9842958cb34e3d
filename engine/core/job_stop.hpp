// Stop requests for long jobs. Long loops check for one; the code that started the job says where it may be cut.
#pragma once

#include <atomic>
#include <utility>

#include "engine/core/error.hpp"

namespace palpate {

/// A job was stopped on request.
class Stopped : public Error {
 public:
  using Error::Error;
};

/// The stop request of a thread's job; its helper threads inherit it.
struct JobStop {
  const std::atomic<bool>* flag = nullptr;  ///< null: the job cannot be stopped
  bool mayCut = false;  ///< any loop that checks may cut the job; otherwise only the code that started it
};

inline thread_local JobStop jobStop;  // of this thread

/// Sets the stop request of this thread while it lives.
class JobStopScope {
 public:
  explicit JobStopScope(const JobStop& sign) : before_(std::exchange(jobStop, sign)) {}
  ~JobStopScope() { jobStop = before_; }
  JobStopScope(const JobStopScope&) = delete;
  JobStopScope& operator=(const JobStopScope&) = delete;

  /// Any loop that checks may cut the job, whose result is then discarded.
  static JobStop cutting() { return {jobStop.flag, true}; }
  /// The job is completed as a whole.
  static JobStop whole() { return {jobStop.flag, false}; }

 private:
  JobStop before_;
};

/// Whether this thread's job has been asked to stop.
inline bool isStopWanted(const JobStop& sign = jobStop) noexcept {
  return sign.flag && sign.flag->load(std::memory_order_relaxed);
}
/// For long loops: throws Stopped if a stop was requested and the job may be cut.
inline void throwIfStopWanted(const JobStop& sign = jobStop) {
  if (sign.mayCut && isStopWanted(sign)) throw Stopped("stopped");
}

}  // namespace palpate
