// The constants of shaders/shared/matter.h, derived from a fluid's properties on the cubic lattice of its rest state.
#pragma once

#include "engine/matter/matter_scene.hpp"
#include "shaders/shared/matter.h"

namespace palpate {

/// Radius of the weights.
inline constexpr double kSupport_spacings = 2.0;
/// Margin of the lists beyond the reach, so that a list is valid for some substeps.
inline constexpr float kListedFarther_spacings = 0.2f;
inline constexpr double kReach_spacings = kSupport_spacings + kListedFarther_spacings;
/// Speed of sound in spacings a substep. One Jacobi iteration overshoots where dt c max |gradient of C in a wave| is
/// above sqrt(4 / 3), which is at 0.98 for weights of this radius.
inline constexpr double kStiffness = 0.7;
/// Kinematic viscosity in spacings^2 a substep: above 0.35 an explicit substep overshoots.
inline constexpr double kMaxDiffusion = 0.2;

/// Share of the error of a contact that each of its two grains corrects in a substep: a grain may have 12 contacts, and
/// all corrections together must not overshoot.
inline constexpr double kGrainShare = 0.05;

/// Minimum distance of a particle to the surface of a model.
inline constexpr double kModelNearest_spacings = 0.25;

/// Distance of a plane, in support radii, with the given share of the weights around a position beyond it; negative if
/// the position itself is beyond it.
double distanceOfShare(double wanted);

/// Sums over a cubic lattice of spacing 1.
struct LatticeSums {
  double weight = 0;  ///< weight of a particle and all its neighbours
  double moment = 0;  ///< sum of wendlandPull(r) (x / support)^2: scale of a gradient or a Laplacian
  double beyond = 0;  ///< sum of the weights beyond a wall, for the first layer, half a spacing from it
  double shear = 0;   ///< sum of wendlandPull(r) times the distance from that layer, beyond the wall
};
LatticeSums latticeSums(double support_spacings);

struct Fluid {
  double spacing_m = 0, density_kg_m3 = 0, viscosity_Pa_s = 0, cohesion_N_m = 0, substep_s = 0;
};
shared::WaterRules waterRules(const Fluid& fluid);
shared::WaterRules waterRules(const MatterScene& scene, const MatterPlan& plan);
shared::GrainRules grainRules(const MatterScene& scene, const MatterPlan& plan);

/// Reach of the particles' interactions, and minimum distance to a wall, in spacings.
struct MatterReach {
  float neighbour_spacings = 0, wall_spacings = 0;
};
MatterReach reachOf(Matter matter);

}  // namespace palpate
