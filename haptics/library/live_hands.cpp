#include "haptics/library/live_hands.hpp"

#include <algorithm>
#include <cmath>
#include <typeinfo>

#include "haptics/devices/path_device.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/devices.hpp"

namespace palpate::library {

namespace {

HandSource opened(const pp_live_options& options, const LiveHands::Surroundings& with, double rate_Hz, bool first) {
  // Only the first hand's device may call the ticks.
  HandConfig config{
      .device = options.device ? options.device : "path", .ownScheduler = !first, .axes = textOf(options.axes)};
  if (!config.axes.empty() && !isHeldDevice(config.device))
    throw UsageError("axes: the device {} is not in a hand; leave axes out", config.device);
  if (options.builtin) config.path = std::string("builtin:") + options.builtin;
  if (options.path) {
    if (options.builtin) throw UsageError("path, builtin: both are given; leave one of them out");
    if (config.device != "path")
      throw UsageError("path: the device {} does not follow a path; leave path or device out", config.device);
    Path path = pathFrom(options.path, rate_Hz);
    const double duration_s = path.duration_s();
    return {.device = std::make_unique<PathDevice>(std::move(path)), .duration_s = duration_s};
  }
  if (config.path.empty() && (config.device == "path" || config.device == "sim"))
    throw UsageError("device: {} requires the path of the hand: give builtin=press, slide, scan or orbit{}",
                     config.device, config.device == "path" ? ", or a path" : "");
  try {
    return openHand(config, {.model = with.session.model(), .rate_Hz = rate_Hz, .log = with.log});
  } catch (const Error& error) {  // of a device or its driver, unless it is of a kind of its own
    if (typeid(error) != typeid(Error) || config.device == "path" || config.device == "sim") throw;
    throw DeviceError("{}", error.what());
  }
}

std::vector<HandSource> openedAll(const pp_live_options& options, const LiveHands::Surroundings& with, double rate_Hz) {
  std::vector<HandSource> hands;
  const std::size_t wanted = with.session.config().hands.size();
  hands.push_back(opened(options, with, rate_Hz, true));
  for (const pp_live_options* next = options.next; next;) {
    if (hands.size() == wanted) throw UsageError("hands: the session has {}, but more are given", wanted);
    const pp_live_options given = optionsFrom(next, "next");
    if (given.law || given.law_library) throw UsageError("next: only the first hand can have a force law");
    if (given.rate_Hz != 0) throw UsageError("next: only the first hand can have a rate");
    hands.push_back(opened(given, with, rate_Hz, false));
    next = given.next;
  }
  if (hands.size() < wanted) throw UsageError("hands: the session has {}, but {} are given", wanted, hands.size());
  return hands;
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
  tick.withheld = row.withheld;
  return tick;
}

LiveHands::LiveHands(const pp_live_options& options, const Surroundings& with)
    : with_(with),
      rate_Hz_(rateFrom(options, with.session)),
      law_(options.law, options.law_user, textOf(options.law_library), with.session.model().scale.mm_per_unit),
      hands_(openedAll(options, with, rate_Hz_)),
      hasLaw_(static_cast<bool>(law_.custom())) {}

void LiveHands::start() {
  std::vector<OpenHand> hands;
  for (const HandSource& source : hands_) hands.push_back(source.hand());
  const CustomForce own = law_.custom();
  with_.session.start(std::move(hands),
                      {.rate_Hz = rate_Hz_, .forcesOn = &with_.forcesOn, .law = own ? own : with_.law});
  run_ = with_.session.live();
}

void LiveHands::stop() {
  stopped_ = true;
  if (run_) run_->pause();
}

std::uint64_t LiveHands::take(const pp_live_rows& rows, ContactEvents& events) {
  if (next_ == waiting_.size()) {
    const bool ended = run_->hasEnded();  // queried before the last ticks are read
    waiting_.clear();
    next_ = 0;
    run_->take(waiting_);
    if (waiting_.empty() && ended) events.endAll();
    if (waiting_.empty() && ended && !stopped_ && !run_->fault().empty()) {
      if (run_->deviceFailed()) throw DeviceError("{}", run_->fault());
      throw GpuError("{}", run_->fault());
    }
  }
  const std::size_t hands = hands_.size();
  const std::uint64_t count = std::min<std::uint64_t>(rows.capacity / hands, (waiting_.size() - next_) / hands);
  for (std::uint64_t i = 0; i < count * hands; ++i) {
    const TraceRow& row = waiting_[next_++];
    rows.ticks[i] = tickOf(row);
    if (rows.ages_s) rows.ages_s[i] = row.age_s;
    putRow(row.torque_mNm, rows.torques_mNm, i);
    if (i % hands != 0) continue;
    const double time_s = row.time_s;
    if (lastTime_s_)
      missed_ += static_cast<std::uint64_t>(std::max(0LL, std::llround((time_s - *lastTime_s_) * rate_Hz_) - 1));
    lastTime_s_ = time_s;
  }
  ticks_ += count;
  for (std::uint64_t i = 0; i < count * hands; ++i) events.felt(i % hands, rows.ticks[i]);
  return count * hands;
}

}  // namespace palpate::library
