// Derived quantities of a scene of a soft body.
#pragma once

#include "engine/matter/matter_simulation.hpp"
#include "engine/matter/soft_body.hpp"

namespace palpate {

SoftMaterial materialOf(const MatterScene& scene);
/// Compliance of a half-space of the scene's material under a force distributed evenly over a disc of that radius (Love
/// 1929), mean over the disc, m/N.
double halfSpaceCompliance_m_N(const MatterScene& scene, double radius_m);
/// Number of substeps per step that a body needs if its stiffest cell has `stiffer` times the stiffness per mass at
/// rest (RestShape).
std::uint32_t substepsOf(const MatterScene& scene, const MatterPlan& plan, double stiffer);

/// Stiffness per mass that holds a free body while its compliance is computed: a period of 1.6 s.
inline constexpr double kHold_1_s2 = 16;

/// planOf() for soft bodies: `lattice` is the number of cells of the fill, `particles` the nodes at their corners; a
/// scan or a ball needs fewer.
MatterPlan softPlanOf(const MatterScene& scene, std::uint64_t memory_bytes);

/// Box of the body: the size of the fill, in the middle of the floor, m.
PlaceBox standOf(const MatterScene& scene);

/// A ball that fits into that box: its centre and radius, m.
struct SoftBall {
  DVec3 middle{0};
  double radius = 0;
};
SoftBall ballOf(const MatterScene& scene);

/// Boxes in which nodes are pinned; slightly enlarged, to include nodes on the faces.
std::vector<PlaceBox> pinsOf(const MatterScene& scene);

/// Kinetic energy above which a body of that mass has diverged: twice that of the whole body at its speed of sound plus
/// that of a fall through the box, J.
double mostSoftKinetic_J(const MatterScene& scene, const MatterPlan& plan, double mass_kg);

/// Adds a body's nodes to an observation: rest positions (m), displacements (m), and masses.
void seeNodes(MatterObservation& seen, const MatterScene& scene, std::span<const Vec3> rest,
              std::span<const Vec3> displacements, std::span<const float> masses);

}  // namespace palpate
