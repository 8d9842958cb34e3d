#pragma once

#include <cstdint>

#include "engine/core/vec.hpp"

namespace palpate {

/// A hand that presses on the surface of a soft body during a step: a spring and a damper between the hand and a
/// position on the surface, which moves with the body. SI units.
struct SurfacePress {
  DVec3 place_m{0};                  ///< on the surface, at the beginning of the step
  DVec3 normal{0};                   ///< there, unit, outward
  DVec3 handFrom_m{0}, handTo_m{0};  ///< at the beginning and at the end of the step
  double radius_m = 0;               ///< radius around the position within which the surface takes the force
  double stiffness_N_m = 0;
  double damping_N_s_m = 0;
  double friction = 0;       ///< Coulomb's coefficient between hand and surface
  double most_N = 0;         ///< maximum force of all presses of the same hand together
  std::uint32_t hand = 0;    ///< number of the hand: a tool of many points presses at several positions
  std::uint32_t touch = 0;   ///< number of the hand or tool point that presses; each presses at most once
  bool isSamePlace = false;  ///< borne by the nodes that bore this touch in the previous step, if it pressed then
};

/// Results of a press.
struct PressReport {
  DVec3 impulse{0};   ///< impulse of the body on the hand in the step, kg m/s
  DVec3 force_N{0};   ///< force of the body on the hand in the last substep
  double work_J = 0;  ///< work of the hand on the spring and damper
  DVec3 place_m{0};   ///< at the end of the step
  /// When its nodes were determined, no surface position that faces it was within its radius.
  bool isAlone = false;
};

}  // namespace palpate
