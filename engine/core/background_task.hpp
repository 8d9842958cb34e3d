#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace palpate {

/// One piece of work that is done again and again on a thread of its own. Starting it and waiting for it allocate
/// nothing; both are for one thread.
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
  std::mutex lock_;
  std::condition_variable changed_;
  bool running_ = false, stop_ = false;
  std::exception_ptr failure_;
  std::jthread thread_;
};

}  // namespace palpate
