#include "haptics/devices/rumble.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/start_thread.hpp"

namespace palpate {
namespace {

constexpr double kTouches_N = 0.05, kLeaves_N = 0.02;  // hysteresis, so that a light touch does not rattle
constexpr double kTap_s = 0.05;                        // the light motor needs 20 ms to be felt
constexpr int kMinTap = 130, kMaxTap = 255;
constexpr int kMinHum = 24, kMaxHum = 200, kHumStep = 8;  // below the minimum the heavy motor does not turn
constexpr double kSmallestShare = 0.01;
constexpr auto kPeriod = std::chrono::milliseconds(10);
constexpr double kForceTimeout_s = 0.1;  // longer than any pause of the servo loop
constexpr double kAgain_s = 0.5;         // the last report is repeated: it may be lost

static_assert(std::atomic<HidConnection*>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
                  std::atomic<float>::is_always_lock_free,
              "a signal handler and the servo thread must not block");

}  // namespace

RumbleMotors RumbleShape::at(double time_s, double share, std::uint32_t contacts) noexcept {
  share = std::clamp(share, 0.0, 1.0);
  RumbleMotors motors;
  if (contacts != contacts_ && time_s >= tapUntil_s_) tapUntil_s_ = time_s + kTap_s;
  contacts_ = contacts;
  if (time_s < tapUntil_s_) motors.weak = static_cast<std::uint8_t>(kMinTap + share * (kMaxTap - kMinTap));
  if (share > kSmallestShare) {
    const int steps = static_cast<int>(share * (kMaxHum - kMinHum) / kHumStep);
    motors.strong = static_cast<std::uint8_t>(kMinHum + kHumStep * steps);
  }
  return motors;
}

Rumble::Rumble(std::shared_ptr<HidTransport> transport, const HidInfo& device, HidRemark remark, double full_N)
    : full_N_(std::isfinite(full_N) ? full_N : kTouchPeakForce_N),
      link_(std::move(transport), device, std::move(remark), "there is no rumble"),
      silence_(dualSenseRumble({}, device.productId)) {
  publish();
  driver_ = startThread([this](const std::stop_token& stop) { drive(stop); });
}

Rumble::~Rumble() {
  driver_.request_stop();
  driver_.join();
  withdraw();
}

void Rumble::setForce(const DVec3& force_N) noexcept {
  const double size_N = glm::length(force_N);
  const bool sane = std::isfinite(size_N);
  const bool touches = sane && size_N > (touching_ ? kLeaves_N : kTouches_N);
  share_.store(static_cast<float>(sane ? std::min(size_N / full_N_, 1.0) : 0.0), std::memory_order_relaxed);
  if (touches && !touching_) contacts_.fetch_add(1, std::memory_order_relaxed);
  touching_ = touches;
  ticks_.fetch_add(1, std::memory_order_relaxed);
}

void Rumble::stop() noexcept {
  stopped_.store(true);
  users_.fetch_add(1);
  if (HidConnection* connection = open_.load()) connection->writeFromSignal(silence_);
  users_.fetch_sub(1);
}

void Rumble::publish() noexcept { open_.store(link_.connection()); }

// A handler on this thread has returned before this continues; one on another thread does so within a write.
void Rumble::withdraw() noexcept {
  open_.store(nullptr);
  while (users_.load() != 0) std::this_thread::yield();
}

void Rumble::send(RumbleMotors motors) {
  HidConnection* connection = link_.connection();
  if (!connection && motors != RumbleMotors{} && link_.find()) {
    publish();
    connection = link_.connection();
  }
  if (!connection) return;
  if (connection->write(dualSenseRumble(motors, link_.device().productId))) {
    sent_ = motors;
    return;
  }
  withdraw();
  link_.lose();
  sent_ = {};
}

void Rumble::drive(const std::stop_token& stop) {
  RumbleShape shape;
  const Stopwatch clock;
  double sentAt_s = 0, heardAt_s = 0;
  std::uint32_t heard = 0;
  while (!stop.stop_requested()) {
    const double now_s = clock.elapsed_s();
    const std::uint32_t ticks = ticks_.load(std::memory_order_relaxed);
    if (std::exchange(heard, ticks) != ticks) heardAt_s = now_s;
    RumbleMotors motors = shape.at(now_s, share_.load(std::memory_order_relaxed), contacts_.load());
    if (stopped_ || now_s - heardAt_s > kForceTimeout_s) motors = {};
    if (motors != sent_ || (motors != RumbleMotors{} && now_s - sentAt_s > kAgain_s)) {
      send(motors);
      sentAt_s = now_s;
    }
    std::this_thread::sleep_for(kPeriod);
  }
  send({});
}

}  // namespace palpate
