// Required accuracy of hands that press on the surface of a soft body, for any implementation.
#pragma once

#include "tests/matter/soft_truths.hpp"

namespace palpate {

/// A hand that presses down on the centre of a block's top from above.
class PressingHand {
 public:
  /// `place_m`: position on the surface.
  PressingHand(const DVec3& place_m, double radius_m, std::uint32_t hand = 0);

  /// Moves to a position within the next step.
  SurfacePress goTo(const DVec3& place_m);
  void heard(const PressReport& report) {
    press_.place_m = report.place_m;
    work_J_ += report.work_J;
  }

  SurfacePress& press() { return press_; }
  double work_J() const { return work_J_; }

 private:
  SurfacePress press_;
  double work_J_ = 0;
};

/// Momentum after each of `steps` steps with pressing hands, with and without pins, is accounted for to 1e-5. The
/// hands' impulses are those of the reports.
void checkPressMomentum(const SoftMaker& make, int steps);
/// Random hands extract less than a millijoule, with and without friction.
void checkPressEnergy(const SoftMaker& make, int steps);
/// On a thin sheet only the side that faces the press moves.
void checkPressedSide(const SoftMaker& make);
/// After a substep nodes beyond a press's reach equal those without it, to the bit, and surface nodes within its radius
/// do not.
void checkPressLocality(const SoftMaker& make);
/// The forces of a hand's presses together stay within its maximum.
void checkMostOfHand(const SoftMaker& make, int steps);
/// A press that is not a number, or on no surface, has no effect.
void checkHostilePresses(const SoftMaker& make);
/// Compliance of a surface equals that of a half-space (Love 1929) within 5 %, and for a free body that of its mass.
/// Queries change nothing.
void checkCompliance(const SoftMaker& make);
/// The same bytes, and again after a reset.
void checkSamePressedBytes(const SoftMaker& one, const SoftMaker& other, int steps);

}  // namespace palpate
