#include "haptics/force_gate.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

namespace {

/// The windings of motors of this size warm and cool with a time constant of ten to thirty seconds. A larger value
/// trusts the motors for longer: at 20 s a Touch gives its peak of 3.3 N for a second before it is reduced.
constexpr double kCooling_s = 20;

/// Share of the allowed heat over which the force is reduced from peak to continuous. A smaller value keeps the peak
/// for longer and then drops it so fast that the hand feels the step.
constexpr double kEasing = 0.3;

/// Time from no force to the whole force. Long enough for a hand to brace itself, short enough not to be waited for.
constexpr double kRamp_s = 0.5;
/// A demand up to this is small: a tenth of a newton is felt but moves no hand.
constexpr double kSmallDemand_N = 0.1;
/// An error up to this long is a dropout: the hand is still where it was, so the force ramps up again without waiting.
constexpr double kLongestDropout_s = 0.1;
/// A pause between two ticks from which on the hand may be anywhere.
constexpr double kLongestPause_s = 0.05;
/// Old data keep their force for this long: at 0.25 m/s, a fast stroke, the hand has then moved 5 mm.
constexpr double kFreshFor_s = 0.02;
/// And it fades over this time; a sudden end would be felt as a knock.
constexpr double kFade_s = 0.05;

}  // namespace

ThermalBudget::ThermalBudget(double peakForce_N, double continuousForce_N) noexcept {
  if (!(peakForce_N > 0 && continuousForce_N > 0)) return;
  peak_N_ = peakForce_N;
  continuous_N_ = std::min(continuousForce_N, peakForce_N);
}

double ThermalBudget::allowed_N() const noexcept {
  if (continuous_N_ == peak_N_) return peak_N_;
  const double room = std::clamp((1 - heat_) / kEasing, 0.0, 1.0);
  // Linear in the square of the force, so that a steady demand settles at the continuous force without overshoot.
  return std::sqrt(continuous_N_ * continuous_N_ + room * (peak_N_ * peak_N_ - continuous_N_ * continuous_N_));
}

void ThermalBudget::spend(double force_N, double dt_s) noexcept {
  if (continuous_N_ == peak_N_ || !(dt_s > 0)) return;
  const double load = force_N / continuous_N_;
  heat_ += (load * load - heat_) * -std::expm1(-dt_s / kCooling_s);  // exact for a constant force
}

ForceGate::ForceGate(const DeviceLimits& limits, double period_s) noexcept
    : motors_(limits.peakForce_N, limits.continuousForce_N),
      period_s_(period_s),
      share_(limits.handHeld ? 0 : 1),
      waiting_(limits.handHeld),
      staleFor_s_(limits.handHeld ? std::numeric_limits<double>::infinity() : 0) {}

DVec3 ForceGate::pass(const DVec3& wanted_N, const TickSigns& signs, double dt_s) noexcept {
  age(signs, dt_s);
  const bool error = isError(wanted_N, signs, dt_s);
  if (error) {
    counts_.errors += errorFor_s_ == 0;
    errorFor_s_ += dt_s > 0 ? dt_s : period_s_;
  }
  const double known = signs.known > 0 ? std::min(signs.known, 1.0) : 0;  // written so that NaN becomes 0
  counts_.aged += known < 1;
  if (!signs.on || signs.jumped || errorFor_s_ > kLongestDropout_s) waiting_ = true;
  if (known == 0 && share_ == 0) waiting_ = true;
  if (!error) errorFor_s_ = 0;
  // Only a fresh answer of the surface may end the wait: no answer, or an old one, is not a small demand.
  if (signs.on && !error && known > 0 && staleFor_s_ <= kFreshFor_s && signs.demand_N <= kSmallDemand_N)
    waiting_ = false;
  if (!signs.on || error || waiting_) {
    share_ = 0;
    return limited(DVec3(0), dt_s);
  }
  raiseOrFade(known, dt_s);
  return limited(share_ * wanted_N, dt_s);
}

bool ForceGate::isError(const DVec3& wanted_N, const TickSigns& signs, double dt_s) const noexcept {
  if (!signs.answered || signs.jumped || !isFinite(wanted_N)) return true;
  return !(dt_s >= 0) || dt_s - period_s_ > kLongestPause_s;
}

void ForceGate::age(const TickSigns& signs, double dt_s) noexcept {
  staleFor_s_ += dt_s > 0 ? dt_s : 0;
  if (signs.age_s < staleFor_s_) staleFor_s_ = std::max(signs.age_s, 0.0);
  if (signs.fresh) staleFor_s_ = 0;
}

void ForceGate::raiseOrFade(double known, double dt_s) noexcept {
  const bool isStale = staleFor_s_ > kFreshFor_s;
  counts_.stale += isStale;
  const double most = isStale ? 0 : known;
  share_ = share_ > most ? std::max(most, share_ - dt_s / kFade_s) : std::min(most, share_ + dt_s / kRamp_s);
}

DVec3 ForceGate::limited(const DVec3& force_N, double dt_s) noexcept {
  const double wanted_N = glm::length(force_N), most_N = motors_.allowed_N();
  const bool tooMuch = wanted_N > most_N;
  hot_ = tooMuch && motors_.isWarm();
  counts_.hot += hot_;
  const DVec3 result = !std::isfinite(wanted_N) ? DVec3(0) : tooMuch ? force_N * (most_N / wanted_N) : force_N;
  motors_.spend(glm::length(result), dt_s);
  return result;
}

}  // namespace palpate
