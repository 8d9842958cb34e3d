// What a scene of a soft body comes to.
#pragma once

#include <optional>

#include "engine/matter/matter_simulation.hpp"
#include "engine/matter/soft_body.hpp"

namespace palpate {

SoftMaterial materialOf(const MatterScene& scene);
/// Of a scene whose preset matches shapes; nothing of others, which are elastic.
std::optional<MatchingRules> matchingOf(const MatterScene& scene, const MatterPlan& plan);
/// How stiff its skin is to what presses on it: SoftContact::Config::frequency_rad_s.
double touchFrequencyOf(const MatterScene& scene, const MatterPlan& plan);
/// How far the surface of a half-space of the scene's material gives way to a force that is spread evenly over a disc
/// of that radius (Love 1929), the mean over the disc, m/N. Of elastic bodies.
double halfSpaceCompliance_m_N(const MatterScene& scene, double radius_m);
/// Substeps in a step that a body needs whose stiffest cell is so many times as stiff for its mass as at rest
/// (RestShape).
std::uint32_t substepsOf(const MatterScene& scene, const MatterPlan& plan, double stiffer);

/// What a body that nothing holds is held by where it is asked how it gives way, for its mass: one round in 1.6 s.
inline constexpr double kHold_1_s2 = 16;

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
