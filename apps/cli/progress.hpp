// Progress bar of a job.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "engine/core/log.hpp"

namespace palpate {

/// Shows the progress from a second on, a few times a second, on a thread of its own. The job only sets a number, which
/// is cheap and allowed on any thread, even a servo thread. The destructor removes the bar.
class Progress {
 public:
  /// `what`: label in front of the bar. `log` must outlive this object; if it is quiet, nothing is shown and no thread
  /// runs.
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
  std::jthread thread_;  // destroyed first
};

}  // namespace palpate
