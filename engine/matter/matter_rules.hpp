// The constants of shaders/shared/matter.h, from what a fluid is: found on the cubic lattice that it rests on.
#pragma once

#include "engine/matter/matter_scene.hpp"
#include "shaders/shared/matter.h"

namespace palpate {

/// Radius of the weights.
inline constexpr double kSupport_spacings = 2.0;
/// Neighbours are listed so much farther than they are met, so that a list is good for some substeps.
inline constexpr float kListedFarther_spacings = 0.2f;
inline constexpr double kReach_spacings = kSupport_spacings + kListedFarther_spacings;
/// Speed of sound in spacings a substep. One Jacobi iteration overshoots where dt c max |gradient of C in a wave| is
/// above sqrt(4 / 3), which is at 0.98 for weights of this radius.
inline constexpr double kStiffness = 0.7;
/// Kinematic viscosity in spacings^2 a substep: above 0.35 an explicit substep overshoots.
inline constexpr double kMaxDiffusion = 0.2;

/// Of what is wrong with a contact of two grains, what each of them puts right in a substep: a grain may have 12
/// contacts, and all of them together must not overshoot.
inline constexpr double kGrainShare = 0.05;

/// No particle comes nearer to the surface of a model.
inline constexpr double kModelNearest_spacings = 0.25;

/// How far a plane is, in support radii, beyond which that share of all weight about a place is; below 0 where the
/// place is beyond it, too.
double distanceOfShare(double wanted);

/// Sums over a cubic lattice of spacing 1.
struct LatticeSums {
  double weight = 0;  ///< of a particle and all its neighbours
  double moment = 0;  ///< of wendlandPull(r) (x / support)^2: what a gradient or a Laplacian is scaled by
  double beyond = 0;  ///< of the weights beyond a wall, for the first layer, which stands half a spacing from it
  double shear = 0;   ///< of wendlandPull(r) times the distance from that layer, beyond the wall
};
LatticeSums latticeSums(double support_spacings);

struct Fluid {
  double spacing_m = 0, density_kg_m3 = 0, viscosity_Pa_s = 0, cohesion_N_m = 0, substep_s = 0;
};
shared::WaterRules waterRules(const Fluid& fluid);
shared::WaterRules waterRules(const MatterScene& scene, const MatterPlan& plan);
shared::GrainRules grainRules(const MatterScene& scene, const MatterPlan& plan);

/// How far particles meet each other, and a wall at the least, in spacings.
struct MatterReach {
  float neighbour_spacings = 0, wall_spacings = 0;
};
MatterReach reachOf(Matter matter);

}  // namespace palpate
