#pragma once

#include <semaphore.h>

#include <atomic>
#include <exception>
#include <functional>
#include <thread>

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
  // Posted by one thread, taken by the other.
  class Signal {
   public:
    Signal() { sem_init(&semaphore_, 0, 0); }
    ~Signal() { sem_destroy(&semaphore_); }
    Signal(const Signal&) = delete;
    Signal& operator=(const Signal&) = delete;
    void post() { sem_post(&semaphore_); }
    void take();
    bool takeWithin(double budget_us);

   private:
    sem_t semaphore_;
  };
  void serve();

  std::function<void()> work_;
  Signal begin_, end_;
  bool running_ = false;  // as the thread that starts and waits knows it
  std::atomic<bool> stop_ = false;
  std::exception_ptr failure_;  // of the last run; between its end and the next begin for the one who waits
  std::jthread thread_;
};

}  // namespace palpate
