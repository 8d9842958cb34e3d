#include "haptics/oscillation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {
namespace {

constexpr double kPower_s = 0.015, kMean_s = 0.1;  // time constants

}  // namespace

bool Oscillation::update(double depth_mm, double stiffness_N_per_mm, double dt_s) noexcept {
  if (!known_) position_mm_ = depth_mm;
  known_ = true;
  if (!(dt_s > 0)) return false;
  constexpr double kTime_s = 1 / (2 * std::numbers::pi * kCorner_Hz);
  const double kept = kTime_s / (kTime_s + dt_s);
  const double once_mm = kept * (once_mm_ + depth_mm - position_mm_);
  fast_mm_ = kept * (fast_mm_ + once_mm - once_mm_);
  once_mm_ = once_mm;
  position_mm_ = depth_mm;
  power_mm2_ += std::min(1.0, dt_s / kPower_s) * (fast_mm_ * fast_mm_ - power_mm2_);
  mean_N_ += std::min(1.0, dt_s / kMean_s) * (stiffness_N_per_mm * std::max(0.0, depth_mm) - mean_N_);
  const double size_N = stiffness_N_per_mm * std::sqrt(power_mm2_);
  isOn_ = size_N > std::max(kSmallest_N, (isOn_ ? kEnds : kBegins) * mean_N_);
  maxPower_mm2_ = std::max(maxPower_mm2_, power_mm2_);
  const bool isSustained = isOn_ && power_mm2_ > kSustained * maxPower_mm2_;
  if (!isSustained) maxPower_mm2_ = power_mm2_;
  sustained_s_ = isSustained ? sustained_s_ + dt_s : 0;
  return sustained_s_ >= kLasts_s;
}

}  // namespace palpate
