// What a scene of a soft body comes to.
#pragma once

#include "engine/matter/matter_scene.hpp"
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

}  // namespace palpate
