#include "haptics/library/live_hands.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <typeinfo>

#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "haptics/devices/path_device.hpp"
#include "haptics/devices/shared_library.hpp"
#include "haptics/hand_force.hpp"
#include "haptics/library/callbacks.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/devices.hpp"

namespace palpate::library {

namespace {

pp_force_law loaded(const std::string& library) {
  const std::size_t colon = library.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == library.size())
    throw UsageError("law: '{}' is not LIBRARY:FUNCTION, as in libmine.so:law", library);
  const std::string file = library.substr(0, colon), name = library.substr(colon + 1);
  const LoadedLibrary opened = loadLibrary(file);
  if (!opened.handle) throw Error("law: {}", opened.error);
  void* const function = functionIn(opened.handle, name);
  if (!function) throw Error("law: {} has no function {}", file, name);
  return reinterpret_cast<pp_force_law>(function);
}

// The event that a pp_contact or a pp_tick reports.
template <class Felt>
pp_contact_event eventOf(std::size_t hand, double t_s, const Felt& felt) {
  pp_contact_event event{};
  event.t_s = t_s;
  std::ranges::copy(felt.proxy, event.proxy);
  std::ranges::copy(felt.normal, event.normal);
  std::ranges::copy(felt.force_N, event.force_N);
  event.hand = static_cast<std::uint32_t>(hand);
  event.begins = 1;
  return event;
}

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

pp_contact contactOf(const Contact& contact, const Pose& pose, const DVec3& force_N, double mm_per_unit) {
  pp_contact told{};
  putVector(contact.proxy, told.proxy);
  putVector(contact.normal, told.normal);
  putVector(force_N, told.force_N);
  told.penetration_mm = contact.touching ? mm_per_unit * glm::length(contact.proxy - pose.hip) : 0;
  told.neighbours = contact.neighbours;
  told.contact = contact.touching;
  told.fresh = contact.fresh;
  told.valid = contact.valid;
  told.age_s = dataAge_s(contact, pose.time_s);
  return told;
}

ForceFunction::ForceFunction(pp_force_law law, void* user, const std::string& library, double mm_per_unit)
    : law_(library.empty() ? law : loaded(library)), user_(user), mm_per_unit_(mm_per_unit) {}

DVec3 ForceFunction::call(void* user, const Contact& contact, const Pose& pose, double dt_s,
                          const DVec3& usual_N) noexcept {
  const auto& self = *static_cast<const ForceFunction*>(user);
  pp_pose told{};
  told.t_s = pose.time_s;
  putVector(pose.hip, told.hip);
  told.no_edit = !pose.sculpts;
  const pp_contact answer = contactOf(contact, pose, usual_N, self.mm_per_unit_);
  double force_N[3]{};
  self.law_(self.user_, &told, &answer, dt_s, force_N);
  const DVec3 given_N(force_N[0], force_N[1], force_N[2]);
  if (std::isfinite(glm::length(given_N))) return given_N;
  if (self.faults_->count.fetch_add(1) == 0) self.faults_->first_s = pose.time_s;
  return DVec3(std::numeric_limits<double>::quiet_NaN());  // no force, as at any fault
}

std::optional<std::string> ForceFunction::takeFault() {
  const std::uint64_t count = faults_->count.exchange(0);
  if (count == 0) return std::nullopt;
  return fmt::format("law: gave a force that is not finite at {}, first at {:.3f} s; there was no force then",
                     counted(count, "tick"), faults_->first_s.load());
}

void ContactEvents::listen(pp_contact_function function, void* user) {
  function_ = function;
  user_ = user;
  last_ = {};
}

void ContactEvents::felt(std::size_t hand, double t_s, const pp_contact& contact) {
  if (function_) tell(hand, contact.contact && contact.valid, eventOf(hand, t_s, contact));
}

void ContactEvents::felt(std::size_t hand, const pp_tick& tick) {
  if (function_) tell(hand, tick.contact && tick.valid, eventOf(hand, tick.t_s, tick));
}

void ContactEvents::tell(std::size_t hand, bool touches, const pp_contact_event& now) {
  last_s_ = now.t_s;
  pp_contact_event& last = last_[hand];
  const bool touched = last.begins != 0;
  if (touches) last = now;
  if (touches == touched) return;
  last.begins = touches;
  pp_contact_event event = last;
  event.t_s = now.t_s;
  const InCallback inside;
  function_(user_, &event);
}

void ContactEvents::endAll() {
  for (std::size_t hand = 0; hand < last_.size(); ++hand)
    if (function_ && last_[hand].begins) tell(hand, false, {.t_s = last_s_});
}

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
