// What a scene of a soft body comes to.
#pragma once

#include "engine/matter/matter_simulation.hpp"
#include "engine/matter/soft_body.hpp"

namespace palpate {

SoftMaterial materialOf(const MatterScene& scene);

/// planOf() for soft bodies: `lattice` is that of cells about the fill, `particles` the nodes at its corners, of which
/// a scan or a ball needs fewer.
MatterPlan softPlanOf(const MatterScene& scene, std::uint64_t memory_bytes);

/// Where the body stands: a box of the size of the fill, in the middle of the floor, m.
PlaceBox standOf(const MatterScene& scene);

/// A ball that fits there: its middle and radius, m.
struct SoftBall {
  DVec3 middle{0};
  double radius = 0;
};
SoftBall ballOf(const MatterScene& scene);

/// Where nodes are pinned; a hair wider than the scene says, for those on its faces.
std::vector<PlaceBox> pinsOf(const MatterScene& scene);

/// A body of that mass may move with its sound as a whole, and with what it has from falling through the box, J.
double mostSoftKinetic_J(const MatterScene& scene, const MatterPlan& plan, double mass_kg);

/// Adds to what is seen of a scene's body where its nodes are: at rest (m), how far from there (m), and their masses.
void seeNodes(MatterObservation& seen, const MatterScene& scene, std::span<const Vec3> rest,
              std::span<const Vec3> displacements, std::span<const float> masses);

}  // namespace palpate
