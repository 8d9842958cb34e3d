#include "engine/matter/soft_rules.hpp"

#include <cmath>

namespace palpate {

namespace {

// Symplectic Euler is stable for w^2 dt^2 + 2 d dt < 4, with frequency w and damping rate d; the margin is for cells
// stiffer than at rest, such as crushed and stretched ones.
constexpr double kBudget = 3;
// Ratio of the skin's stiffness to that below it, in squared frequencies.
constexpr double kTouchStiffness = 2;

}  // namespace

shared::SoftRules softRules(const SoftMaterial& material, double spacing_m) {
  const double shear = material.shear_Pa();
  const double lame = material.bulk_Pa() - 2.0 / 3 * shear;
  // So that small strains follow Hooke's law (Smith, de Goes, Kim 2018, section 3.4).
  const double energyShear = 4.0 / 3 * shear, energyBulk = lame + 5.0 / 6 * shear;
  const double square = spacing_m * spacing_m;
  shared::SoftRules rules{};
  rules.shear = static_cast<float>(energyShear);
  rules.bulk = static_cast<float>(energyBulk);
  rules.restVolume = static_cast<float>(1 + 0.75 * energyShear / energyBulk);
  rules.viscosity = static_cast<float>(material.viscosity_Pa_s);
  // Mean square distance from the centre of a cell, a twelfth of the squared edge, by which bending strains; and its
  // square.
  rules.bend = static_cast<float>(material.young_Pa / (48 * square));
  rules.twist = static_cast<float>(material.young_Pa / (144 * square));
  rules.bendDrag = static_cast<float>(3 * material.viscosity_Pa_s / (48 * square));  // 3: Trouton, as for stretching
  rules.perEdges = static_cast<float>(1 / (4 * spacing_m));
  return rules;
}

double highestFrequency(const SoftMaterial& material, double spacing_m) {
  return std::sqrt(12 * material.bulk_Pa() / material.density_kg_m3) / spacing_m;
}

double touchFrequency(const SoftMaterial& material, double spacing_m) {
  return std::sqrt(kTouchStiffness) * highestFrequency(material, spacing_m);
}

double longestSubstep(const SoftMaterial& material, double spacing_m, double touched_kg_per_kg, double stiffer) {
  const double own = highestFrequency(material, spacing_m), touch = touchFrequency(material, spacing_m);
  const double both = 1 + touched_kg_per_kg;
  const double square = stiffer * own * own + touch * touch * both;
  const double damping = stiffer * 8 * material.viscosity_Pa_s / (material.density_kg_m3 * spacing_m * spacing_m) +
                         kTouchDamping * touch * both;
  return kBudget / (damping + std::sqrt(damping * damping + square * kBudget));
}

}  // namespace palpate
