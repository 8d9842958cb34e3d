#include "haptics/guided_touch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

// An aim that jumps from picture to picture becomes a motion: it is approached with this time constant, and not faster
// than a quick hand.
constexpr double kGlide_s = 0.03, kFastest_mm_per_s = 600;
constexpr double kSmallestStep_mm = 1e-3;  // of what the stylus tells: no encoder that could be felt

SimulatedTouchOptions handOptions() {
  return {.handStiffness_N_per_mm = 0.6,
          .handDamping_N_s_per_mm = 0.006,
          .friction_N = 0,
          .encoderStep_mm = kSmallestStep_mm,
          .workspace_mm = DVec3(1e6)};  // a mouse has no stops
}

}  // namespace

GuidedTouch::GuidedTouch(const WorkspaceMap& map, const DVec3& parked)
    : parked_(parked),
      glide_(parked),
      hand_(
          [this, unitsPer_mm = map.scale](double time_s) {
            const double dt_s = std::max(time_s - std::exchange(glideTime_s_, time_s), 0.0);
            const DVec3 way = (last_.lifted ? parked_ : last_.place) - glide_;
            const double length = glm::length(way), farthest = kFastest_mm_per_s * unitsPer_mm * dt_s;
            double share = 1 - std::exp(-dt_s / kGlide_s);
            if (share * length > farthest) share = farthest / length;
            glide_ += share * way;
            return glide_;
          },
          map, handOptions()) {
  aim_.place = last_.place = parked;
}

void GuidedTouch::tell(const Aim& aim) noexcept {
  // A sequence lock: the version is odd while the aim is being written. Who sees a part of a new aim sees an odd
  // version or a later one, since each part is released after the version was changed.
  const std::uint32_t version = version_.load(std::memory_order_relaxed);
  version_.store(version + 1, std::memory_order_relaxed);
  for (int k = 0; k < 3; ++k) place_[static_cast<std::size_t>(k)].store(aim.place[k], std::memory_order_release);
  lifted_.store(aim.lifted, std::memory_order_release);
  putDowns_.store(aim.putDowns, std::memory_order_release);
  version_.store(version + 2, std::memory_order_release);
}

GuidedTouch::Aim GuidedTouch::told() noexcept {
  const std::uint32_t before = version_.load(std::memory_order_acquire);
  Aim aim;
  for (int k = 0; k < 3; ++k) aim.place[k] = place_[static_cast<std::size_t>(k)].load(std::memory_order_acquire);
  aim.lifted = lifted_.load(std::memory_order_acquire);
  aim.putDowns = putDowns_.load(std::memory_order_acquire);
  const bool whole = before % 2 == 0 && before != 0 && version_.load(std::memory_order_relaxed) == before;
  return whole ? aim : last_;
}

void GuidedTouch::aim(const DVec3& place) noexcept {
  if (!isFinite(place)) return;
  aim_.putDowns += std::exchange(aim_.lifted, false);
  aim_.place = place;
  tell(aim_);
}

void GuidedTouch::lift() noexcept {
  aim_.lifted = true;
  tell(aim_);
}

DeviceState GuidedTouch::read(double time_s) noexcept {
  const Aim aim = told();
  const bool moved = aim.putDowns != last_.putDowns || aim.lifted != last_.lifted;
  last_ = aim;
  if (moved) {
    glide_ = aim.lifted ? parked_ : aim.place;
    glideTime_s_ = time_s;
    hand_.putDown(time_s);
  }
  DeviceState state = hand_.read(time_s);
  state.putDown = moved;
  return state;
}

}  // namespace palpate
