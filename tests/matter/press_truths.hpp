// What hands that press on the surface of a soft body have to be true to, whoever simulates it.
#pragma once

#include "tests/matter/soft_truths.hpp"

namespace palpate {

/// A hand that presses down on a block's top from above its middle.
class PressingHand {
 public:
  /// `place_m`: of the surface.
  PressingHand(const DVec3& place_m, double radius_m, std::uint32_t hand = 0);

  /// Goes to a place within the next step.
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

/// Momentum after each of so many steps in which hands press, and pins hold: to 1e-5. What hands got is what the
/// reports say.
void checkPressMomentum(const SoftMaker& make, int steps);
/// Random hands get less than a millijoule out, with friction and without.
void checkPressEnergy(const SoftMaker& make, int steps);
/// Of a sheet only the side that faces the press.
void checkPressedSide(const SoftMaker& make);
/// After a substep all nodes but those within a press's reach are to the bit as without it, and those of the surface
/// within its radius are not.
void checkPressLocality(const SoftMaker& make);
/// The presses of a hand together are never more than it bears.
void checkMostOfHand(const SoftMaker& make, int steps);
/// What is no number, or presses nowhere, does nothing.
void checkHostilePresses(const SoftMaker& make);
/// How a surface gives way is that of a half-space (Love 1929), within 5 %; of a body that nothing holds, that of its
/// mass. Asking changes nothing.
void checkCompliance(const SoftMaker& make);
/// The same bytes, and again after a reset.
void checkSamePressedBytes(const SoftMaker& one, const SoftMaker& other, int steps);

}  // namespace palpate
