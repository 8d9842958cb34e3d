#include "engine/core/log.hpp"

#include <cstdio>

#include "engine/core/console.hpp"
#include "engine/core/job_stop.hpp"
#include "engine/core/shown_names.hpp"

namespace palpate {

Log::Log(bool quiet) : quiet_(quiet), terminal_(isErrorConsole()) {}

void Log::write(std::string_view text, void (LogListener::*how)(std::string_view)) {
  const std::string line = withShownNames(std::string(text));
  const std::scoped_lock lock(lock_);
  if (listener_) (listener_->*how)(line);
  if (quiet_) return;
  clearBar();
  fmt::print(stderr, "{}\n", line);
}

void Log::clearBar() {
  if (barShown_) fmt::print(stderr, "\r\033[K");
  barShown_ = false;
}

void Log::endProgress() {
  const std::scoped_lock lock(lock_);
  clearBar();
  progressOf_.clear();
  lastStep_ = -1;
}

void Log::progress(std::string_view what, double fraction) {
  throwIfStopWanted();
  const std::scoped_lock lock(lock_);
  if (listener_) listener_->progressed(what, fraction);
  if (quiet_) return;
  constexpr double kShort_us = 1e6;
  if (what != progressOf_) {
    clearBar();
    lastStep_ = -1;
    progressOf_ = what;
    progressSince_ = Stopwatch();
  }
  if (progressSince_.elapsed_us() < kShort_us && !barShown_) return;
  const int percent = static_cast<int>(fraction * 100);
  const int step = terminal_ ? percent : percent / 25;
  if (step == lastStep_) return;
  lastStep_ = step;
  if (fraction >= 1) lastStep_ = -1;
  if (!terminal_) {
    fmt::print(stderr, "{}: {} %\n", what, percent);
    return;
  }
  const int filled = percent * 30 / 100;
  fmt::print(stderr, "\r\033[K{} [{:=<{}}{: <{}}] {} %", what, "", filled, "", 30 - filled, percent);
  barShown_ = true;
  if (fraction >= 1) clearBar();
}

}  // namespace palpate
