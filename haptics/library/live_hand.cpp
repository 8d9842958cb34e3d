#include "haptics/library/live_hand.hpp"

#include <algorithm>
#include <cmath>

#include "haptics/devices/path_device.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/options.hpp"

namespace palpate::library {

namespace {

HandSource opened(const pp_live_options& options, const LiveHand::Surroundings& with, double rate_Hz) {
  HandConfig config{.device = options.device ? options.device : "path"};
  if (options.builtin) config.path = std::string("builtin:") + options.builtin;
  if (options.path) {
    if (options.builtin || config.device != "path")
      throw UsageError("path: goes with the device path alone, and not with builtin");
    Path path = pathFrom(options.path, rate_Hz);
    const double duration_s = path.duration_s();
    return {.device = std::make_unique<PathDevice>(std::move(path)), .duration_s = duration_s};
  }
  if (config.path.empty() && (config.device == "path" || config.device == "sim"))
    throw UsageError("device: {} follows a path, or builtin, and neither is given", config.device);
  return openHand(config, {.model = with.session.model(), .rate_Hz = rate_Hz, .log = with.log});
}

double rateFrom(const pp_live_options& options, const Session& session) {
  if (options.rate_Hz == 0) return session.config().rate_Hz;
  SessionConfig config = session.config();
  config.rate_Hz = options.rate_Hz;
  validate(config);
  return options.rate_Hz;
}

}  // namespace

pp_tick tickOf(const TraceRow& row) {
  pp_tick tick{};
  tick.t_s = row.time_s;
  for (int k = 0; k < 3; ++k) {
    tick.hip[k] = row.hip[k];
    tick.proxy[k] = row.proxy[k];
    tick.normal[k] = row.normal[k];
    tick.force_N[k] = row.force_N[k];
  }
  tick.penetration_mm = row.penetration_mm;
  tick.neighbours = row.neighbours;
  tick.contact = row.contact;
  tick.fresh = row.fresh;
  tick.valid = row.valid;
  return tick;
}

LiveHand::LiveHand(const pp_live_options& options, const Surroundings& with)
    : rate_Hz_(rateFrom(options, with.session)),
      law_(options.law, options.law_user, textOf(options.law_library), with.session.model().scale.mm_per_unit),
      hand_(opened(options, with, rate_Hz_)) {
  const CustomForce own = law_.custom();
  thread_.emplace(with.session, hand_.hand(),
                  ServoThread::Options{.forcesOn = &with.forcesOn, .law = own ? own : with.law, .rate_Hz = rate_Hz_});
}

void LiveHand::stop() {
  stopped_ = true;
  thread_->stop();
}

std::uint64_t LiveHand::take(pp_tick* ticks, std::uint64_t capacity) {
  if (next_ == waiting_.size()) {
    const bool ended = thread_->hasEnded();  // before the last ticks are taken
    waiting_.clear();
    next_ = 0;
    thread_->take(waiting_);
    if (waiting_.empty() && ended && !stopped_) {
      const std::string why = thread_->fault().empty() ? "the servo thread has ended" : thread_->fault();
      if (thread_->deviceFailed()) throw DeviceError("{}", why);
      throw GpuError("{}", why);
    }
  }
  const std::uint64_t count = std::min<std::uint64_t>(capacity, waiting_.size() - next_);
  for (std::uint64_t i = 0; i < count; ++i) {
    const TraceRow& row = waiting_[next_++];
    ticks[i] = tickOf(row);
    if (lastTime_s_)
      missed_ += static_cast<std::uint64_t>(std::max(0LL, std::llround((row.time_s - *lastTime_s_) * rate_Hz_) - 1));
    lastTime_s_ = row.time_s;
  }
  ticks_ += count;
  return count;
}

}  // namespace palpate::library
