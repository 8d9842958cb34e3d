#pragma once

#include <cstdint>

#include "engine/core/vec.hpp"

namespace palpate {

/// A hand that presses on the surface of a soft body through a step: a spring and a damper between a place of the
/// surface, which goes where the body goes, and the hand. SI units.
struct SurfacePress {
  DVec3 place_m{0};                  ///< of the surface, at the beginning of the step
  DVec3 normal{0};                   ///< there, unit, outward
  DVec3 handFrom_m{0}, handTo_m{0};  ///< at the beginning and at the end of the step
  double radius_m = 0;               ///< about the place, within which the surface takes the force
  double stiffness_N_m = 0;
  double damping_N_s_m = 0;
  double friction = 0;       ///< Coulomb's coefficient between hand and surface
  double most_N = 0;         ///< of all presses of the same hand together
  std::uint32_t hand = 0;    ///< whose it is: a tool of many points presses in many places
  std::uint32_t touch = 0;   ///< number of the hand or point of a tool that presses, of which each presses once
  bool isSamePlace = false;  ///< the nodes bear it that bore this touch in the step before, if it pressed then
};

/// What came of it.
struct PressReport {
  DVec3 impulse{0};   ///< of the body on the hand, over the step, kg m/s
  DVec3 force_N{0};   ///< of the body on the hand, in the last substep
  double work_J = 0;  ///< of the hand on the spring and damper
  DVec3 place_m{0};   ///< at the end of the step
  /// When the nodes that bear it were found, no place of the surface was within its radius that faces it.
  bool isAlone = false;
};

}  // namespace palpate
