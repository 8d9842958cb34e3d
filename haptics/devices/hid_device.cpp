#include "haptics/devices/hid_device.hpp"

#include <algorithm>
#include <utility>

#include "haptics/devices/guided_touch.hpp"
#include "haptics/devices/hid_choice.hpp"

namespace palpate {
namespace {

constexpr double kMaxPush_mm_per_s = 120;  // at full push: crosses the workspace in about a second
constexpr double kEase_s = 0.03;           // smooths the motion between reports, which are received every 4 to 16 ms
// Maximum lead of the intended position over the stylus: with the cap at rest and at full push. Times the stiffness of
// the hand it is the force with which it presses: 0.3 N, and a little less than the maximum of a Touch.
constexpr double kAheadAtRest_mm = 0.5, kFarthestAhead_mm = 5;
// A larger lead, because the surface pushed the stylus back or the cap was released, decays slowly: an intended
// position that followed the stylus at once would not damp its motion.
constexpr double kYield_s = 0.1;
// Damping of the hand. Critical for its mass between its own spring and a surface of 1.5 N/mm, so that a push into a
// wall comes to rest there, even at a few hundred ticks per second; no real hand has to feel it.
constexpr double kDamping_N_s_per_mm = 0.02;
constexpr double kForceRamp_s = 0.5;  // duration of the ramp of forces

SimulatedTouchOptions steeredHand() {
  SimulatedTouchOptions hand = guidedHand(kTouchWorkspace_mm);
  hand.handDamping_N_s_per_mm = kDamping_N_s_per_mm;
  return hand;
}

}  // namespace

HidDevice::HidDevice(std::shared_ptr<HidTransport> transport, const HidInfo& device, const DVec3& start_mm,
                     HidRemark remark)
    : name_(nameOf(device)),
      listener_(std::move(transport), device, std::move(remark), "the stylus stays where it is, without force,"),
      position_mm_(start_mm),
      intended_mm_(start_mm),
      hand_([this](double time_s) { return intendedAt(time_s); }, {}, steeredHand()) {}

DeviceLimits HidDevice::limits() const {
  DeviceLimits limits = hand_.limits();
  limits.continuousForce_N = limits.peakForce_N;
  limits.buttons = 2;
  return limits;
}

DeviceState HidDevice::read(double time_s) noexcept {
  const HidPush& push = listener_.now();
  if (!push.plugged) {
    adrift_ = true;
    return {.position = position_mm_, .rendersForce = false, .ok = true};
  }
  if (std::exchange(adrift_, false)) {
    intended_mm_ = position_mm_;
    speed_mm_per_s_ = DVec3(0);
    intendedTime_s_ = time_s;
    waitsUntil_s_ = time_s + kForceRamp_s;
    hand_.putDown(time_s);
  }
  const bool waits = time_s < waitsUntil_s_;
  asked_mm_per_s_ = waits ? DVec3(0) : kMaxPush_mm_per_s * push.motion.push;
  DeviceState state = hand_.read(time_s);
  state.buttons = push.motion.buttons;
  position_mm_ = state.position;
  return state;
}

DVec3 HidDevice::intendedAt(double time_s) noexcept {
  const double dt_s = time_s - std::exchange(intendedTime_s_, time_s);
  if (!(dt_s > 0)) return intended_mm_;
  speed_mm_per_s_ += (1 - std::exp(-dt_s / kEase_s)) * (asked_mm_per_s_ - speed_mm_per_s_);
  const double push = glm::length(speed_mm_per_s_) / kMaxPush_mm_per_s;
  const double enough_mm = kAheadAtRest_mm + push * (kFarthestAhead_mm - kAheadAtRest_mm);
  const DVec3 hand_mm = hand_.position_mm(), ahead_mm = intended_mm_ - hand_mm + dt_s * speed_mm_per_s_;
  const double before_mm = glm::distance(intended_mm_, hand_mm), length_mm = glm::length(ahead_mm);
  if (length_mm > enough_mm) {
    const double kept_mm = std::min(length_mm, std::max(before_mm, enough_mm)) - enough_mm;
    intended_mm_ = hand_mm + ahead_mm * ((enough_mm + kept_mm * std::exp(-dt_s / kYield_s)) / length_mm);
  } else {
    intended_mm_ = hand_mm + ahead_mm;
  }
  return intended_mm_;
}

}  // namespace palpate
