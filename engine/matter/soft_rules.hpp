// The constants of shaders/shared/soft.h, from what a material is, and how long a substep may be.
#pragma once

#include "shaders/shared/soft.h"

namespace palpate {

struct SoftMaterial {
  double young_Pa = 0;       ///< Young's modulus
  double poisson = 0;        ///< Poisson's ratio, from 0 to below 0.5
  double density_kg_m3 = 0;  ///< kg/m^3
  double viscosity_Pa_s =
      0;  ///< of Kelvin and Voigt's solid: stress is that of strain plus twice this by the strain's rate

  double shear_Pa() const { return young_Pa / (2 * (1 + poisson)); }
  double bulk_Pa() const { return young_Pa / (3 * (1 - 2 * poisson)); }
};

shared::SoftRules softRules(const SoftMaterial& material, double spacing_m);

/// Highest angular frequency that a cell has by itself, whatever it is filled with, rad/s: it bounds that of any body.
double highestFrequency(const SoftMaterial& material, double spacing_m);

/// Of what is pressed on, by its own mass: its skin is so stiff that less than a hundredth of a spacing gives way under
/// what bodies bear, whatever the substeps are, rad/s.
double touchFrequency(const SoftMaterial& material, double spacing_m);
/// Damping of a touch, of its stiffness over its frequency.
inline constexpr double kTouchDamping = 0.2;

/// Longest stable substep, s. `touched_kg_per_kg`: the most mass of nodes that a tool may press on at a time, over the
/// tool's own. `stiffer`: how many times the stiffest cell is as stiff for its mass as a cube at rest.
double longestSubstep(const SoftMaterial& material, double spacing_m, double touched_kg_per_kg, double stiffer = 1);

}  // namespace palpate
