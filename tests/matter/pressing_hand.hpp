// A hand that presses on the surface of a soft body, in tests.
#pragma once

#include "tests/matter/soft_maker.hpp"

namespace palpate {

/// A hand that presses down on the centre of a block's top from above.
class PressingHand {
 public:
  /// `place_m`: position on the surface.
  PressingHand(const DVec3& place_m, double radius_m, std::uint32_t hand = 0)
      : press_{.place_m = place_m,
               .normal = {0, 1, 0},
               .handFrom_m = place_m,
               .handTo_m = place_m,
               .radius_m = radius_m,
               .stiffness_N_m = 500,
               .damping_N_s_m = 1,
               .friction = 0.4,
               .most_N = 5,
               .hand = hand} {}

  /// Moves to a position within the next step.
  SurfacePress goTo(const DVec3& place_m) {
    press_.handFrom_m = press_.handTo_m;
    press_.handTo_m = place_m;
    return press_;
  }
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

}  // namespace palpate
