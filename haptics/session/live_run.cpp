#include "haptics/session/live_run.hpp"

#include <utility>

#include "engine/core/start_thread.hpp"

namespace palpate {

LiveRun::LiveRun(std::vector<OpenHand> hands, LiveRunOptions options, ServoMailbox& mailbox, Play play)
    : hands_(std::move(hands)),
      options_(std::move(options)),
      mailbox_(mailbox),
      play_(std::move(play)),
      feed_(hands_.size()) {
  resume();
}

void LiveRun::resume() {
  if (thread_.joinable()) return;
  stop_ = false;
  ended_ = false;
  fault_.clear();
  deviceFailed_ = false;
  if (options_.clock) options_.clock->hold();
  mailbox_.open(options_.clock.get());
  try {
    thread_ = startThread([this, options = options_] { run(options); });
  } catch (const std::exception& error) {
    mailbox_.close();
    fault_ = error.what();
    ended_ = true;
    if (options_.clock) options_.clock->leave();
    throw;
  }
}

void LiveRun::run(const LiveRunOptions& options) {
  try {
    const ServoResult result = play_(hands_, options, stop_, feed_);
    deviceFailed_ = result.deviceFailed;
    fault_ = result.fault;
  } catch (const std::exception& error) {
    fault_ = error.what();
  }
  mailbox_.close();  // from now on commands run on the threads that give them
  if (fault_.empty() && !stop_) fault_ = "the servo thread has ended";
  ended_ = true;
  if (options.clock) options.clock->leave();
}

// Releases the clock once only: another session may already use it.
bool LiveRun::pause() {
  if (!thread_.joinable()) return false;
  stop_ = true;
  if (options_.clock) options_.clock->letGo();
  wake();
  thread_.join();
  feed_.take(before_);
  if (!before_.empty()) options_.begin_s = before_.back().time_s + 1 / options_.rate_Hz;
  return true;
}

void LiveRun::take(std::vector<TraceRow>& rows) {
  rows.insert(rows.end(), before_.begin(), before_.end());
  before_.clear();
  const std::size_t fresh = rows.size();
  feed_.take(rows);
  if (rows.size() > fresh) options_.begin_s = rows.back().time_s + 1 / options_.rate_Hz;
}

}  // namespace palpate
