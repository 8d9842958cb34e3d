#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <thread>

#include "engine/core/semaphore.hpp"

namespace palpate {

/// Repeated work on its own thread. Starting it and waiting for it allocate nothing and take no lock, so that a
/// real-time thread can do both: preempting the work at any moment cannot delay that thread past its budget. start()
/// and finishedWithin() are called by the same thread.
class BackgroundTask {
 public:
  explicit BackgroundTask(std::function<void()> work);
  /// Waits for a run in progress.
  ~BackgroundTask();
  BackgroundTask(const BackgroundTask&) = delete;
  BackgroundTask& operator=(const BackgroundTask&) = delete;

  /// Starts a run; the previous run must have finished.
  void start();
  /// Waits for the run in progress, at most `budget_us` (0: without limit). True when no run is in progress. Rethrows
  /// an exception of the run once.
  bool finishedWithin(double budget_us);

 private:
  void serve();

  std::function<void()> work_;
  Semaphore begin_, end_;
  bool running_ = false;  // as known by the thread that starts and waits
  std::atomic<bool> stop_ = false;
  std::exception_ptr failure_;  // of the last run; read only between the end of a run and the next start
  std::jthread thread_;
};

}  // namespace palpate
