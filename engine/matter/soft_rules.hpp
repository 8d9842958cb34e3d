// The constants of shaders/shared/soft.h, derived from a material, and the longest stable substep.
#pragma once

#include "shaders/shared/soft.h"

namespace palpate {

struct SoftMaterial {
  double young_Pa = 0;        ///< Young's modulus
  double poisson = 0;         ///< Poisson's ratio, from 0 to below 0.5
  double density_kg_m3 = 0;   ///< kg/m^3
  double viscosity_Pa_s = 0;  ///< of a Kelvin-Voigt solid: stress of the strain plus twice this times the strain rate

  double shear_Pa() const { return young_Pa / (2 * (1 + poisson)); }
  double bulk_Pa() const { return young_Pa / (3 * (1 - 2 * poisson)); }
};

shared::SoftRules softRules(const SoftMaterial& material, double spacing_m);

/// Highest angular frequency of a single cell, for any fill, rad/s: it bounds that of any body.
double highestFrequency(const SoftMaterial& material, double spacing_m);

/// Frequency of the skin's contact springs for the mass that they press on: so stiff that they yield less than a
/// hundredth of a spacing under bearable loads, independently of the substeps, rad/s.
double touchFrequency(const SoftMaterial& material, double spacing_m);
/// Damping of a contact, in units of its stiffness over its frequency.
inline constexpr double kTouchDamping = 0.2;

/// Longest stable substep, s. `touched_kg_per_kg`: maximum mass of nodes that a tool presses on at a time, relative to
/// the tool's mass. `stiffer`: stiffness per mass of the stiffest cell, relative to a cube at rest.
double longestSubstep(const SoftMaterial& material, double spacing_m, double touched_kg_per_kg, double stiffer = 1);

}  // namespace palpate
