#include "haptics/devices/haply_device.hpp"

#include <algorithm>
#include <ctime>
#include <utility>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "haptics/realtime_priority.hpp"
#include "haptics/session_clock.hpp"

namespace palpate {
namespace {

using haply::Trouble;

constexpr std::int64_t kNs_per_ms = 1'000'000;
constexpr std::int64_t kStale_ns = 20 * kNs_per_ms;   // of a state, and of a force
constexpr std::int64_t kLost_ns = 1000 * kNs_per_ms;  // without a good state; then the device is considered lost
constexpr std::int64_t kShortestExchange_ns = kNs_per_ms / 4;
/// Longer than the dropout after which ForceGate goes on where it was.
constexpr std::int64_t kQuiet_ns = 150 * kNs_per_ms;
constexpr double kStale_s = 0.02, kFirst_s = 2, kAsk_s = 0.5, kPatience_s = 0.02, kZeroWait_us = 5000;
constexpr double kSmallestJump_mm = 1;
/// Middle of the reach, in palpate's axes, and half the edge of a cube within it.
constexpr DVec3 kMiddle_mm{0, 150, 120};
constexpr double kReach_mm = 80, kReachOfMinverse_mm = 30;

std::int64_t now_ns() noexcept { return machineClock().now_ns(); }

std::string listOf(const std::vector<haply::Inverse>& inverses) {
  std::string list;
  for (const haply::Inverse& inverse : inverses)
    list += fmt::format("{}haply:{} ({} hand{})", list.empty() ? "" : ", ", inverse.id, inverse.handedness,
                        inverse.inUse ? ", in use" : "");
  return list;
}

HaplyLink connected(const haply::Ports& ports) try { return HaplyLink(ports.simulation); } catch (const Error& error) {
  throw Error(
      "haply: the Haply service does not answer ({}); install it from Haply, and start it: sudo systemctl start "
      "haply-inverse-service, or the Haply Hub",
      error.what());
}

}  // namespace

HaplyService::HaplyService() : ports(haply::servicePorts()), link(connected(ports)) {
  const Stopwatch since;
  while (link.hear(kFirst_s, first) != HaplyLink::Heard::message)
    if (since.elapsed_s() >= kFirst_s)
      throw Error("haply: the Haply service takes connections but tells no devices; start it again");
  auto found = haply::inventoryIn(first);
  if (!found) throw Error("haply: the Haply service's first message is no JSON; update the service");
  inventory = std::move(*found);
  for (const std::uint16_t port : ports.http)
    for (const char* path : {"/version", "/3.1/version", "/3.0/version"})
      if (version.empty())
        if (const auto answer = askHaplyService(port, path, kAsk_s)) version = haply::versionIn(*answer);
  try {
    events = std::make_unique<HaplyLink>(ports.events);
  } catch (const Error&) {
    events.reset();
  }
}

HaplyDevice::HaplyDevice(const HaplyOptions& options) : options_(options), service_(std::make_unique<HaplyService>()) {
  choose();
  chooseGrip();
  values_ = haply::saysValues(service_->version);
  if (!service_->events && options_.say)
    options_.say("the Haply service has no channel of events: a stop by its safety is seen only as a stale state");
  good_ns_ = now_ns();
  state_ = haply::stateIn(service_->first, choice_, state_);  // no jump from the origin
  accept(service_->first, good_ns_);
  publish(good_ns_);
  exchange_ = std::jthread([this](const std::stop_token& stop) { exchange(stop); });
}

HaplyDevice::~HaplyDevice() = default;

void HaplyDevice::choose() {
  const std::vector<haply::Inverse>& inverses = service_->inventory.inverses;
  if (inverses.empty())
    throw Error("haply: the Haply service has no Inverse3; check its cable and power supply, and the Haply Hub");
  if (options_.serial.empty() && inverses.size() > 1)
    throw Error("haply: there are {} devices; choose one by its serial number: {}", inverses.size(), listOf(inverses));
  const auto chosen =
      options_.serial.empty() ? inverses.begin() : std::ranges::find(inverses, options_.serial, &haply::Inverse::id);
  if (chosen == inverses.end())
    throw Error("haply: there is no device '{}'; there is {}", options_.serial, listOf(inverses));
  if (chosen->inUse && !options_.shares)
    throw Error(
        "haply: another program uses {}, and the forces of both would add up; close it, or ask for it all the same: "
        "haply:{}:shared",
        chosen->id, chosen->id);
  const auto axes = haply::axesOf(chosen->permutation);
  if (!axes)
    throw Error("haply: the axes of {} are '{}', which is no permutation of XYZ; reset its basis in the Haply Hub",
                chosen->id, chosen->permutation);
  choice_.id = chosen->id;
  choice_.axes = *axes;
  facts_ = {.model = fmt::format("{} {}", chosen->small ? "Minverse" : "Inverse3", chosen->id),
            .serial = chosen->id,
            .driver = fmt::format("service {}, firmware {}", service_->version.empty() ? "unknown" : service_->version,
                                  chosen->firmware.empty() ? "unknown" : chosen->firmware)};
  const double reach_mm = chosen->small ? kReachOfMinverse_mm : kReach_mm;
  facts_.workspaceMin_mm = kMiddle_mm - DVec3(reach_mm);
  facts_.workspaceMax_mm = kMiddle_mm + DVec3(reach_mm);
  limits_ = {.forceDelay_ticks = 1};
  if (!options_.say) return;
  options_.say(fmt::format("the stylus is {}, set up for the {} hand", facts_.model, chosen->handedness));
  if (chosen->permutation != "XYZ")
    options_.say(
        fmt::format("{}: its axes are permuted ({}), which palpate undoes", facts_.model, chosen->permutation));
}

/// With several devices, the grip at the device's place.
void HaplyDevice::chooseGrip() {
  std::vector<haply::Grip> grips = service_->inventory.grips;
  std::erase_if(grips, [](const haply::Grip& grip) { return !grip.connected; });
  if (grips.empty()) return;
  const std::vector<haply::Inverse>& inverses = service_->inventory.inverses;
  const auto place = std::ranges::find(inverses, choice_.id, &haply::Inverse::id) - inverses.begin();
  const haply::Grip& grip = grips[std::min(static_cast<std::size_t>(place), grips.size() - 1)];
  choice_.grip = grip.id;
  choice_.wireless = grip.wireless;
  limits_.buttons = grip.wireless ? 2 : 1;
  if (options_.say)
    options_.say(fmt::format("{}: orientation and buttons of the {} grip {}{}", facts_.model,
                             grip.wireless ? "wireless" : "wired", grip.id,
                             grip.battery ? fmt::format(", battery {:.0f} %", 100 * *grip.battery) : ""));
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
  if (isSilent) {
    const bool wasSilent = state_.trouble == Trouble::silent;
    state_.trouble = Trouble::silent;
    enter(Trouble::silent, now);
    publish(now);
    if (!wasSilent && !send(DVec3(0))) return true;
  } else {
    unanswered_ = std::max(unanswered_ - 1, 0);
    accept(message, now);
    publish(now);
  }
  if (now - good_ns_ > kLost_ns) {
    fault_.store(state_.trouble);
    return false;
  }
  if (isSilent || unanswered_ > 0) return true;
  std::this_thread::sleep_for(std::chrono::nanoseconds(sent_ns_ + kShortestExchange_ns - now));
  const bool stops = stopped_.load();
  send(permitted_N(now_ns()));
  if (stops) zeroSent_.store(true);
  return true;
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
  const Trouble trouble = safetyHolds_                                              ? Trouble::safety
                          : state_.trouble != Trouble::none                         ? state_.trouble
                          : since_ns > kStale_ns                                    ? Trouble::silent
                          : glm::distance(before_mm, state_.position_mm) > reach_mm ? Trouble::jumped
                                                                                    : Trouble::none;
  if (trouble != Trouble::none) enter(trouble, now_ns);
}

void HaplyDevice::enter(Trouble trouble, std::int64_t now_ns) {
  quietUntil_ns_ = now_ns + kQuiet_ns;
  tell(trouble);
}

void HaplyDevice::tell(Trouble trouble) {
  if (std::exchange(told_, trouble) != trouble && options_.say)
    options_.say(fmt::format("{} {}", facts_.model, haply::meaningOf(trouble)));
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
