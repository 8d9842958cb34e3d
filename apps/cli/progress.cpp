#include "apps/cli/progress.hpp"

#include <algorithm>
#include <chrono>

#include "engine/core/job_stop.hpp"

namespace palpate {

Progress::Progress(Log& log, std::string what) : log_(log), what_(std::move(what)) {
  if (log.isQuiet()) return;
  thread_ = std::jthread([this](const std::stop_token& stop) {
    constexpr std::chrono::milliseconds kBetween{250};
    std::unique_lock hold(lock_);
    while (!stop.stop_requested()) {
      log_.progress(what_, std::clamp(fraction_.load(std::memory_order_relaxed), 0.0, 1.0));
      ends_.wait_for(hold, stop, kBetween, [] { return false; });
    }
  });
}

Progress::~Progress() {
  if (!thread_.joinable()) return;
  thread_ = {};
  const JobStopScope whole(JobStopScope::whole());  // a stop must not skip the end of the bar
  if (fraction_ >= 1) log_.progress(what_, 1);
  log_.endProgress();
}

}  // namespace palpate
