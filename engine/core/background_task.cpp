#include "engine/core/background_task.hpp"

#include <chrono>
#include <utility>

#include "engine/core/check.hpp"

namespace palpate {

BackgroundTask::BackgroundTask(std::function<void()> work) : work_(std::move(work)), thread_([this] { serve(); }) {}

BackgroundTask::~BackgroundTask() {
  {
    const std::scoped_lock hold(lock_);
    stop_ = true;
  }
  changed_.notify_all();
}

void BackgroundTask::start() {
  {
    const std::scoped_lock hold(lock_);
    PALPATE_CHECK(!running_);
    running_ = true;
  }
  changed_.notify_all();
}

bool BackgroundTask::finishedWithin(double budget_us) {
  std::unique_lock hold(lock_);
  const auto finished = [this] { return !running_; };
  if (budget_us > 0)
    changed_.wait_for(hold, std::chrono::duration<double, std::micro>(budget_us), finished);
  else
    changed_.wait(hold, finished);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return !running_;
}

void BackgroundTask::serve() {
  std::unique_lock hold(lock_);
  while (true) {
    changed_.wait(hold, [this] { return running_ || stop_; });
    if (!running_) return;
    hold.unlock();
    std::exception_ptr failure;
    try {
      work_();
    } catch (...) {
      failure = std::current_exception();
    }
    hold.lock();
    failure_ = failure;
    running_ = false;
    changed_.notify_all();
  }
}

}  // namespace palpate
