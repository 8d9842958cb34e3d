#include "haptics/devices/haply_device.hpp"

#include <algorithm>
#include <ctime>
#include <utility>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "engine/core/start_thread.hpp"
#include "haptics/realtime_priority.hpp"

namespace palpate {
namespace {

using haply::Trouble;

constexpr std::int64_t kNs_per_ms = 1'000'000;
constexpr std::int64_t kStale_ns = 20 * kNs_per_ms;   // of a state, and of a force
constexpr std::int64_t kLost_ns = 1000 * kNs_per_ms;  // without a good state; then the device is considered lost
constexpr std::int64_t kShortestExchange_ns = kNs_per_ms / 4;
/// Longer than the dropout after which ForceGate continues where it was.
constexpr std::int64_t kQuiet_ns = 150 * kNs_per_ms;
constexpr double kStale_s = 0.02, kPatience_s = 0.02, kZeroWait_us = 5000;
constexpr double kSmallestJump_mm = 1;
/// Middle of the reach, in palpate's axes, and half the edge of a cube within it.
constexpr DVec3 kMiddle_mm{0, 150, 120};
constexpr double kReach_mm = 80, kReachOfMinverse_mm = 30;

}  // namespace

HaplyDevice::HaplyDevice(const HaplyOptions& options)
    : options_(options),
      clock_(options.clock ? *options.clock : machineClock()),
      service_(std::make_unique<HaplyService>()),
      reports_([this](Trouble trouble) { say(fmt::format("{} {}", facts_.model, haply::meaningOf(trouble))); }) {
  choose();
  values_ = haply::saysValues(service_->version);
  if (!service_->events) say("the Haply service has no event channel, so it does not report a stop by its safety");
  good_ns_ = now_ns();
  state_ = haply::stateIn(service_->first, choice_, state_);  // no jump from the origin
  accept(service_->first, good_ns_);
  publish(good_ns_);
  exchange_ = startThread([this](const std::stop_token& stop) { exchange(stop); });
}

HaplyDevice::~HaplyDevice() = default;

void HaplyDevice::choose() {
  const haply::Inverse& chosen = service_->device(options_.serial, options_.shares);
  const auto axes = haply::axesOf(chosen.permutation);
  if (!axes)
    throw Error("haply: the axes of {} are '{}', which is not a permutation of XYZ; reset its basis in the Haply Hub",
                chosen.id, chosen.permutation);
  choice_ = {.id = chosen.id, .axes = *axes};
  facts_ = {.model = fmt::format("{} {}", chosen.small ? "Minverse" : "Inverse3", chosen.id),
            .serial = chosen.id,
            .driver = fmt::format("service {}, firmware {}", service_->version.empty() ? "unknown" : service_->version,
                                  chosen.firmware.empty() ? "unknown" : chosen.firmware),
            .handedness = chosen.handedness,
            .axes = chosen.permutation,
            .lights = std::string(haply::kLights)};
  const double reach_mm = chosen.small ? kReachOfMinverse_mm : kReach_mm;
  facts_.workspaceMin_mm = kMiddle_mm - DVec3(reach_mm);
  facts_.workspaceMax_mm = kMiddle_mm + DVec3(reach_mm);
  limits_ = {.forceDelay_ticks = 1};
  say(fmt::format("the stylus is {}, set up for the {} hand", facts_.model, chosen.handedness));
  if (chosen.permutation != "XYZ")
    say(fmt::format("{}: its axes are permuted ({}), which palpate undoes", facts_.model, chosen.permutation));
  const haply::Grip* grip = service_->gripOf(chosen);
  if (!grip) return;
  choice_.grip = grip->id;
  choice_.wireless = grip->wireless;
  limits_.buttons = grip->wireless ? 2 : 1;
  facts_.grip = fmt::format("{} grip {}", grip->wireless ? "wireless" : "wired", grip->id);
  facts_.battery = grip->battery;
  say(fmt::format("{}: orientation and buttons of the {} grip {}{}", facts_.model,
                  grip->wireless ? "wireless" : "wired", grip->id,
                  grip->battery ? fmt::format(", battery {:.0f} %", 100 * *grip->battery) : ""));
}

void HaplyDevice::say(const std::string& sentence) {
  if (options_.say) options_.say(sentence);
}

void HaplyDevice::exchange(const std::stop_token& stop) {
  const RealtimePriority priority;
  std::string message;
  send(DVec3(0));
  while (!stop.stop_requested() && exchangeOnce(message)) {
  }
  send(DVec3(0));
  zeroSent_.store(true);
  service_->link.hear(kPatience_s, message);
}

bool HaplyDevice::exchangeOnce(std::string& message) {
  hearEvents();
  const HaplyLink::Heard heard = service_->link.hear(kStale_s, message);
  const std::int64_t now = now_ns();
  if (heard == HaplyLink::Heard::closed) {
    fault_.store(Trouble::closed);
    return false;
  }
  const bool isSilent = heard == HaplyLink::Heard::nothing;
  if (isSilent && now - sent_ns_ < kStale_ns) return true;  // by a clock that is slower than the machine's
  if (isSilent) {
    const bool wasSilent = state_.trouble == Trouble::silent;
    state_.trouble = Trouble::silent;
    unanswered_ = 0;  // a service that was busy may answer several commands at once
    enter(Trouble::silent, now);
    publish(now);
    if (!wasSilent && !send(DVec3(0))) return true;
  } else {
    take(message, now);
  }
  if (now - good_ns_ > kLost_ns) {
    fault_.store(state_.trouble);
    return false;
  }
  if (isSilent || unanswered_ > 0) return true;
  if (!options_.clock) std::this_thread::sleep_for(std::chrono::nanoseconds(sent_ns_ + kShortestExchange_ns - now));
  while (service_->link.hear(0, message) == HaplyLink::Heard::message) take(message, now_ns());
  const bool stops = stopped_.load();
  send(permitted_N(now_ns()));
  if (stops) zeroSent_.store(true);
  return true;
}

void HaplyDevice::take(const std::string& message, std::int64_t now_ns) {
  unanswered_ = std::max(unanswered_ - 1, 0);
  accept(message, now_ns);
  publish(now_ns);
}

void HaplyDevice::hearEvents() {
  if (!service_->events) return;
  std::string event;
  HaplyLink::Heard heard;
  while ((heard = service_->events->hear(0, event)) == HaplyLink::Heard::message) {
    const haply::Safety safety = haply::safetyIn(event, choice_.id);
    if (safety == haply::Safety::struck || safety == haply::Safety::stopped) enter(Trouble::safety, now_ns());
    if (safety == haply::Safety::stopped) safetyHolds_ = true;
    if (safety == haply::Safety::released) safetyHolds_ = false;
  }
  if (heard == HaplyLink::Heard::closed) service_->events.reset();
}

void HaplyDevice::accept(const std::string& message, std::int64_t now_ns) {
  const DVec3 before_mm = state_.position_mm;
  const std::int64_t since_ns = now_ns - good_ns_;
  state_ = haply::stateIn(message, choice_, state_);
  if (haply::hasPose(state_.trouble)) good_ns_ = now_ns;
  const double reach_mm = limits_.fastest_mm_per_s * 1e-9 * static_cast<double>(since_ns) + kSmallestJump_mm;
  const bool isShared = forces_.showsAnother(state_.force_N) && !options_.shares;
  const Trouble trouble = safetyHolds_                                              ? Trouble::safety
                          : state_.trouble != Trouble::none                         ? state_.trouble
                          : since_ns > kStale_ns                                    ? Trouble::silent
                          : glm::distance(before_mm, state_.position_mm) > reach_mm ? Trouble::jumped
                          : isShared                                                ? Trouble::shared
                                                                                    : Trouble::none;
  if (trouble != Trouble::none) enter(trouble, now_ns);
}

void HaplyDevice::enter(Trouble trouble, std::int64_t now_ns) {
  quietUntil_ns_ = now_ns + kQuiet_ns;
  tell(trouble);
}

void HaplyDevice::tell(Trouble trouble) {
  if (std::exchange(told_, trouble) != trouble) reports_.post(trouble);
}

void HaplyDevice::publish(std::int64_t now_ns) {
  const bool renders = now_ns >= quietUntil_ns_;
  if (renders) tell(Trouble::none);
  shown_.store({.position_mm = state_.position_mm,
                .turn = state_.turn,
                .buttons = state_.buttons,
                .rendersForce = renders,
                .time_ns = good_ns_});
}

DVec3 HaplyDevice::permitted_N(std::int64_t now_ns) noexcept {
  if (const auto wanted = wanted_.load()) newest_ = *wanted;
  const bool gives = now_ns >= quietUntil_ns_ && !stopped_.load() && now_ns - newest_.time_ns <= kStale_ns;
  return gives ? newest_.force_N : DVec3(0);
}

bool HaplyDevice::send(const DVec3& force_N) {
  sent_ns_ = now_ns();
  ++unanswered_;
  forces_.sent(force_N);
  return service_->link.say(haply::forceMessage(choice_, force_N, values_, !std::exchange(introduced_, true)),
                            kPatience_s);
}

DeviceState HaplyDevice::read(double /*time_s*/) noexcept {
  if (fault_.load() != Trouble::none) return {};
  if (const auto shown = shown_.load()) last_ = *shown;
  return {.position = last_.position_mm,
          .turn = last_.turn,
          .buttons = last_.buttons,
          .rendersForce = last_.rendersForce && now_ns() - last_.time_ns <= kStale_ns,
          .ok = true};
}

bool HaplyDevice::write(const DVec3& force_N) noexcept {
  const bool sane = isFinite(force_N);
  const double size_N = sane ? glm::length(force_N) : 0;
  const bool failed = fault_.load() != Trouble::none;
  wanted_.store({.force_N = !sane || failed                ? DVec3(0)
                            : size_N > limits_.peakForce_N ? force_N * (limits_.peakForce_N / size_N)
                                                           : force_N,
                 .time_ns = now_ns()});
  return sane && !failed;
}

void HaplyDevice::resume() noexcept {
  stopped_.store(false);
  zeroSent_.store(false);
}

void HaplyDevice::emergencyStop() noexcept {
  stopped_.store(true);
  // Measured by the clock: a system without such short sleeps does not sleep at all.
  const Stopwatch since;
  while (since.elapsed_us() < kZeroWait_us && !zeroSent_.load()) {
    const timespec nap{.tv_sec = 0, .tv_nsec = 100'000};
    ::nanosleep(&nap, nullptr);
  }
}

std::string HaplyDevice::faultText() const {
  const Trouble fault = fault_.load();
  return fault == Trouble::none ? std::string() : fmt::format("{} {}", facts_.model, haply::meaningOf(fault));
}

}  // namespace palpate
