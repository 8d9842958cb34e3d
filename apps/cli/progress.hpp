// How far a job has come, for the person who waits for it.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "engine/core/log.hpp"

namespace palpate {

/// Shows it from a second on, a few times a second, on a thread of its own: who does the job only sets a number, which
/// costs no more than that and may be done on any thread, a servo thread among them. What was shown goes away with it.
class Progress {
 public:
  /// `what` stands in front of the bar. `log` outlives this; where it is quiet nothing is shown and no thread runs.
  Progress(Log& log, std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// From 0 to 1.
  void set(double fraction) noexcept { fraction_.store(fraction, std::memory_order_relaxed); }

 private:
  Log& log_;
  std::string what_;
  std::atomic<double> fraction_ = 0;
  std::mutex lock_;
  std::condition_variable_any ends_;
  std::jthread thread_;  // goes first
};

}  // namespace palpate
