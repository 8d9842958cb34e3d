#include "haptics/devices/guided_touch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

// An aim that jumps from picture to picture becomes a motion: it is approached with this time constant, at most at the
// speed of a quick hand.
constexpr double kGlide_s = 0.03, kMaxGlide_mm_per_s = 600;
constexpr double kSmallestStep_mm = 1e-3;  // resolution of the stylus: imperceptible

const DVec3 kNoStops_mm(1e6);  // a mouse has no stops

}  // namespace

SimulatedTouchOptions guidedHand(const DVec3& workspace_mm) {
  return {.handStiffness_N_per_mm = 0.6,
          .handDamping_N_s_per_mm = 0.006,
          .friction_N = 0,
          .encoderStep_mm = kSmallestStep_mm,
          .workspace_mm = workspace_mm};
}

GuidedTouch::GuidedTouch(const WorkspaceMap& map, const DVec3& parked)
    : parked_(parked),
      glide_(parked),
      hand_(
          [this, unitsPer_mm = map.scale](double time_s) {
            const double dt_s = std::max(time_s - std::exchange(glideTime_s_, time_s), 0.0);
            const DVec3 way = (last_.lifted ? parked_ : last_.place) - glide_;
            const double length = glm::length(way), farthest = kMaxGlide_mm_per_s * unitsPer_mm * dt_s;
            double share = 1 - std::exp(-dt_s / kGlide_s);
            if (share * length > farthest) share = farthest / length;
            glide_ += share * way;
            return glide_;
          },
          map, guidedHand(kNoStops_mm)) {
  aim_.place = last_.place = parked;
}

DeviceLimits GuidedTouch::limits() const {
  DeviceLimits limits = hand_.limits();
  limits.buttons = 1;
  return limits;
}

void GuidedTouch::aim(const DVec3& place, bool sculpts) noexcept {
  if (!isFinite(place)) return;
  aim_.putDowns += std::exchange(aim_.lifted, false);
  aim_.place = place;
  aim_.sculpts = sculpts;
  latest_.store(aim_);
}

void GuidedTouch::putDown(const DVec3& place, bool sculpts) noexcept {
  aim_.lifted = true;
  aim(place, sculpts);
}

void GuidedTouch::lift() noexcept {
  aim_.lifted = true;
  aim_.sculpts = false;
  latest_.store(aim_);
}

DeviceState GuidedTouch::read(double time_s) noexcept {
  const Aim aim = latest_.load().value_or(last_);
  const bool moved = aim.putDowns != last_.putDowns || aim.lifted != last_.lifted;
  last_ = aim;
  if (moved) {
    glide_ = aim.lifted ? parked_ : aim.place;
    glideTime_s_ = time_s;
    hand_.putDown(time_s);
  }
  DeviceState state = hand_.read(time_s);
  state.putDown = moved;
  state.buttons = aim.sculpts ? kSculptButton : 0;
  return state;
}

}  // namespace palpate
