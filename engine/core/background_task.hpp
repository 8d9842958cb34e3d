#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <thread>

#include "engine/core/semaphore.hpp"

namespace palpate {

/// One piece of work that is done again and again on a thread of its own. Starting it and waiting for it allocate
/// nothing and take no lock, so that a real-time thread may do both: the work may be put aside at any moment without
/// holding it up past its budget. Both are for one thread.
class BackgroundTask {
 public:
  explicit BackgroundTask(std::function<void()> work);
  /// Waits for a run that is under way.
  ~BackgroundTask();
  BackgroundTask(const BackgroundTask&) = delete;
  BackgroundTask& operator=(const BackgroundTask&) = delete;

  /// Begins a run; the last one must have finished.
  void start();
  /// Waits for the run that is under way, `budget_us` at most (0: as long as it takes). True when none is any more.
  /// Throws, once, what the run threw.
  bool finishedWithin(double budget_us);

 private:
  void serve();

  std::function<void()> work_;
  Semaphore begin_, end_;
  bool running_ = false;  // as the thread that starts and waits knows it
  std::atomic<bool> stop_ = false;
  std::exception_ptr failure_;  // of the last run; between its end and the next begin for the one who waits
  std::jthread thread_;
};

}  // namespace palpate
