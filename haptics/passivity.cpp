#include "haptics/passivity.hpp"

#include <algorithm>

namespace palpate {

Passivity::Passivity(PassivityMode mode, const DeviceLimits& limits) noexcept
    : mode_(mode),
      mostDamping_N_s_per_mm_(limits.mostDamping_N_s_per_mm),
      delay_(static_cast<std::size_t>(std::clamp(limits.forceDelay_ticks, 0, static_cast<int>(kMostDelay)))) {}

// Under a zero-order hold the energy between two reads is exactly the held force times the way between them, whatever
// the velocity did in between (Stramigioli et al. 2005), so no velocity has to be estimated to observe it.
DVec3 Passivity::damped(const DVec3& wanted_N, const DVec3& position_mm, double dt_s,
                        const DVec3& surface_mm_per_s) noexcept {
  if (mode_ == PassivityMode::off || !isFinite(position_mm)) return wanted_N;
  const DVec3 way_mm = known_ ? position_mm - position_mm_ - dt_s * surface_mm_per_s : DVec3(0);
  position_mm_ = position_mm;
  known_ = true;
  energy_mJ_ -= glm::dot(forces_N_[delay_], way_mm);  // the force on the hand, so a push outwards costs
  leastEnergy_mJ_ = std::min(leastEnergy_mJ_, energy_mJ_);
  const double way2_mm2 = glm::dot(way_mm, way_mm);
  if (mode_ == PassivityMode::observe || energy_mJ_ >= 0 || !(way2_mm2 > 0) || !(dt_s > 0)) return wanted_N;
  if (wanted_N == DVec3(0)) return wanted_N;  // free space is free, whatever is owed

  // alpha = -E / (dt v^2) gives the debt back within a tick if the hand keeps its velocity.
  double alpha_N_s_per_mm = std::min(-energy_mJ_ * dt_s / way2_mm2, mostDamping_N_s_per_mm_);
  const DVec3 velocity_mm_per_s = way_mm / dt_s;
  const double power_mW = glm::dot(wanted_N, velocity_mm_per_s);
  if (power_mW > 0) alpha_N_s_per_mm = std::min(alpha_N_s_per_mm, glm::dot(wanted_N, wanted_N) / power_mW);
  return wanted_N - alpha_N_s_per_mm * velocity_mm_per_s;
}

void Passivity::acted(const DVec3& force_N) noexcept {
  std::shift_right(forces_N_.begin(), forces_N_.end(), 1);
  forces_N_[0] = force_N;
  const auto isGone = [](const DVec3& force) { return force == DVec3(0); };
  if (std::all_of(forces_N_.begin(), forces_N_.begin() + static_cast<std::ptrdiff_t>(delay_) + 1, isGone))
    energy_mJ_ = 0;
}

void Passivity::lift() noexcept { known_ = false; }

}  // namespace palpate
