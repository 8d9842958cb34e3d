#include "engine/core/background_task.hpp"

#include <utility>

#include "engine/core/check.hpp"
#include "engine/core/start_thread.hpp"

namespace palpate {

BackgroundTask::BackgroundTask(std::function<void()> work)
    : work_(std::move(work)), thread_(startThread([this] { serve(); })) {}

BackgroundTask::~BackgroundTask() {
  if (running_) end_.take();
  stop_ = true;
  begin_.post();
}

void BackgroundTask::start() {
  PALPATE_CHECK(!running_);
  running_ = true;
  begin_.post();
}

bool BackgroundTask::finishedWithin(double budget_us) {
  if (!running_) return true;
  if (budget_us > 0) {
    if (!end_.takeWithin(budget_us)) return false;
  } else {
    end_.take();
  }
  running_ = false;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return true;
}

void BackgroundTask::serve() {
  while (true) {
    begin_.take();
    if (stop_) return;
    try {
      work_();
    } catch (...) {
      failure_ = std::current_exception();
    }
    end_.post();
  }
}

}  // namespace palpate
