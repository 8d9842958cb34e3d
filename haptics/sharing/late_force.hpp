// A force that another program has computed, which acts later than the motion that caused it.
#pragma once

#include <algorithm>
#include <optional>

#include "engine/core/vec.hpp"

namespace palpate {

/// Limits a late force so that a hand gets no more energy from it than it has put in, but for kLent_mJ: a time-domain
/// passivity controller (Hannaford, Ryu 2002). The force of a tick acts until the next one, over a displacement that
/// differs from the last one by up to kFarther_mm. The force is scaled so that the remaining energy covers that. At 1
/// kHz this holds for accelerations up to 25 g; a larger jerk may exceed the limit. Energies in mJ (N mm), of the model
/// in millimetres.
class LateForce {
 public:
  static constexpr double kLent_mJ = 0.45, kFarther_mm = 0.25;
  static constexpr double kMax_N = 100;  ///< the force is limited to this size in any case
  /// Maximum of the energy that counts: that of a ball of 25 mm pressed 7 cm into water.
  static constexpr double kMaxStored_mJ = 50;

  /// The part of `wanted_N` that a hand at `position_mm` gets. `felt`: share of the last force that it has received.
  DVec3 at(const DVec3& position_mm, double felt, DVec3 wanted_N) noexcept {
    constexpr double kBeginning_mJ = 1e-7;  // minimum that is left, so that a hand that presses in again adds energy
    const DVec3 way_mm = position_mm_ ? position_mm - *position_mm_ : DVec3(0);
    position_mm_ = position_mm;
    energy_mJ_ = std::clamp(energy_mJ_ - felt * glm::dot(force_N_, way_mm), kBeginning_mJ - kLent_mJ, kMaxStored_mJ);
    const double size_N = glm::length(wanted_N);
    if (!(size_N > 0)) return force_N_ = DVec3(0);
    if (size_N > kMax_N) wanted_N *= kMax_N / size_N;
    const double mayCost_mJ = glm::dot(wanted_N, way_mm) + std::min(size_N, kMax_N) * kFarther_mm;
    const double left_mJ = energy_mJ_ + kLent_mJ;
    return force_N_ = mayCost_mJ > left_mJ ? left_mJ / mayCost_mJ * wanted_N : wanted_N;
  }
  /// The next position is not reached by a displacement. The energy stays.
  void lift() noexcept { position_mm_.reset(); }

 private:
  std::optional<DVec3> position_mm_;
  DVec3 force_N_{0};
  double energy_mJ_ = 0;  // that the hand has put in
};

}  // namespace palpate
