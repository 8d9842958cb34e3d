#include "haptics/passivity.hpp"

#include <cmath>

namespace palpate {
namespace {

/// Rate at which a limited force returns: that of a surface that changes (ForceLaw).
constexpr double kReturn_N_per_s = 60;
/// If no energy is left, none is taken in either, since nothing resists the hand. So a hand that sinks in, farther than
/// the noise of encoders, gets a small force to press against, at a small cost.
constexpr double kSinks_mm = 0.1, kBeginning_N = 0.05;
/// A custom law may have no spring.
constexpr double kSoftest_N_per_mm = 0.05;
/// Speed of a hand that withdraws from something hot, faster than one that strokes or explores.
constexpr double kFast_mm_per_s = 200;
/// Until the force acts, it may speed up the hand by this factor, or the hand may keep accelerating for this long.
constexpr double kFaster = 1.25, kAhead_ticks = 2;

}  // namespace

Passivity::Passivity(PassivityMode mode, const DeviceLimits& limits, double stiffness_N_per_mm) noexcept
    : mode_(mode),
      mostDamping_N_s_per_mm_(limits.mostDamping_N_s_per_mm),
      delay_(static_cast<std::size_t>(std::clamp(limits.forceDelay_ticks, 0, static_cast<int>(kMaxDelay)))) {
  setStiffness(stiffness_N_per_mm);
}

void Passivity::setStiffness(double stiffness_N_per_mm) noexcept {
  stiffness_N_per_mm_ = std::max(stiffness_N_per_mm, kSoftest_N_per_mm);
}

// Under a zero-order hold the energy between two reads is exactly the held force times the displacement between them,
// whatever the velocity in between (Stramigioli et al. 2005), so the observer needs no estimate of a velocity.
DVec3 Passivity::damped(const DVec3& wanted_N, const DVec3& position_mm, double dt_s,
                        const DVec3& surface_mm_per_s) noexcept {
  if (mode_ == PassivityMode::off || !isFinite(position_mm)) return wanted_N;
  isWanted_ = wanted_N != DVec3(0);
  const DVec3 way_mm = known_ ? position_mm - position_mm_ - dt_s * surface_mm_per_s : DVec3(0);
  position_mm_ = position_mm;
  known_ = true;
  energy_mJ_ -= glm::dot(forces_N_[delay_], way_mm);  // the force acts on the hand, so a push outwards costs energy
  leastEnergy_mJ_ = std::min(leastEnergy_mJ_, energy_mJ_);
  const DVec3 lastWay_mm = std::exchange(lastWay_mm_, way_mm);
  if (mode_ == PassivityMode::observe || !(dt_s > 0)) return wanted_N;
  if (!isWanted_) return wanted_N;  // free space stays free, whatever the deficit
  if (isLending_) return lent(wanted_N, way_mm, dt_s);
  return withinMeans(braked(wanted_N, way_mm, dt_s), way_mm, way_mm - lastWay_mm, dt_s);
}

// The remaining energy after the forces in flight to the motors, if the hand keeps its velocity.
double Passivity::leftAlong_mJ(const DVec3& way_mm) const noexcept {
  double left_mJ = energy_mJ_;
  for (std::size_t i = 0; i < delay_; ++i) left_mJ -= std::max(0.0, glm::dot(forces_N_[i], way_mm));
  return left_mJ;
}

// In its last tick in the surface a hand at 1 m/s gets the force of a depth that is a millimetre too large: some mJ
// that it has not put in, and no damper gets them back in free space. For a slow hand this is negligible, and left to
// the damper.
DVec3 Passivity::withinMeans(const DVec3& force_N, const DVec3& way_mm, const DVec3& change_mm,
                             double dt_s) const noexcept {
  DVec3 next_mm = way_mm + kAhead_ticks * change_mm;
  if (const DVec3 faster_mm = kFaster * way_mm; glm::dot(force_N, faster_mm) > glm::dot(force_N, next_mm))
    next_mm = faster_mm;
  const double size_N = glm::length(force_N);
  const double outwards_mm = size_N > 0 ? glm::dot(force_N, next_mm) / size_N : 0;
  if (!(outwards_mm > kFast_mm_per_s * dt_s)) return force_N;
  const double most_N = std::max(0.0, leftAlong_mJ(next_mm)) / outwards_mm;
  return size_N > most_N ? most_N / size_N * force_N : force_N;
}

// alpha = -E / (dt v^2) recovers the deficit within a tick if the hand keeps its velocity.
DVec3 Passivity::braked(const DVec3& wanted_N, const DVec3& way_mm, double dt_s) const noexcept {
  const double way2_mm2 = glm::dot(way_mm, way_mm);
  if (energy_mJ_ >= 0 || !(way2_mm2 > 0)) return wanted_N;
  double alpha_N_s_per_mm = std::min(-energy_mJ_ * dt_s / way2_mm2, mostDamping_N_s_per_mm_);
  const DVec3 velocity_mm_per_s = way_mm / dt_s;
  const double power_mW = glm::dot(wanted_N, velocity_mm_per_s);
  if (power_mW > 0) alpha_N_s_per_mm = std::min(alpha_N_s_per_mm, glm::dot(wanted_N, wanted_N) / power_mW);
  return wanted_N - alpha_N_s_per_mm * velocity_mm_per_s;
}

// A spring of this stiffness that stores the energy E pushes with sqrt(2 k E), and gives exactly E as it relaxes (the
// energy tank of Franken et al. 2011, emptied by a spring). Forces in flight to the motors are already deducted.
DVec3 Passivity::lent(const DVec3& force_N, const DVec3& way_mm, double dt_s) noexcept {
  const double left_mJ = leftAlong_mJ(way_mm) + kLent_mJ;
  const double size_N = glm::length(force_N), inwards_mm = -glm::dot(force_N, way_mm) / size_N;
  if (inwards_mm != 0) sunk_mm_ = inwards_mm > 0 ? sunk_mm_ + inwards_mm : 0;
  const bool mayBegin = sunk_mm_ >= kSinks_mm && left_mJ > -kBeginning_mJ;
  double most_N = std::max(std::sqrt(2 * stiffness_N_per_mm_ * std::max(0.0, left_mJ)), mayBegin ? kBeginning_N : 0);
  if (held_N_) most_N = std::min(most_N, *held_N_ + kReturn_N_per_s * dt_s);
  most_N = std::max(most_N, fallingTo(most_N, size_N, inwards_mm, dt_s));
  held_N_ = size_N > most_N ? std::optional(most_N) : std::nullopt;
  return held_N_ ? *held_N_ / size_N * force_N : force_N;
}

// A force above that limit, as where others begin to change the surface, falls to it by 60 N/s, and as a spring relaxes
// where the hand moves out. At rest that costs nothing. What it gives a hand that moves out is energy that this side
// has not put in: once kFall_mJ of it are given in a contact, or for a hand that withdraws fast, the force is cut.
double Passivity::fallingTo(double most_N, double size_N, double inwards_mm, double dt_s) noexcept {
  const double outwards_mm = std::max(0.0, -inwards_mm);
  if (last_N_ <= most_N || outwards_mm > kFast_mm_per_s * dt_s) return most_N;
  const double next_N = last_N_ - kReturn_N_per_s * dt_s - stiffness_N_per_mm_ * outwards_mm;
  // It acts until the next tick at least, and the hand may be faster then.
  gift_mJ_ += std::max(0.0, std::min(next_N, size_N) - most_N) * kFaster * outwards_mm;
  return gift_mJ_ > kFall_mJ ? most_N : next_N;
}

void Passivity::acted(const DVec3& force_N) noexcept {
  std::shift_right(forces_N_.begin(), forces_N_.end(), 1);
  forces_N_[0] = force_N;
  last_N_ = glm::length(force_N);
  const auto isGone = [](const DVec3& force) { return force == DVec3(0); };
  // A limited force still acts: its contact has not ended.
  if (isLending_ && isWanted_) return;
  if (std::all_of(forces_N_.begin(), forces_N_.begin() + static_cast<std::ptrdiff_t>(delay_) + 1, isGone)) end();
}

void Passivity::end() noexcept {
  energy_mJ_ = 0;
  isLending_ = false;
  sunk_mm_ = gift_mJ_ = 0;
  held_N_.reset();
}

void Passivity::lift() noexcept {
  known_ = false;
  lastWay_mm_ = DVec3(0);
}

}  // namespace palpate
