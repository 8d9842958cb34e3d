// Required accuracy of matter, for any implementation. Each check makes its own simulations.
#pragma once

#include "tests/matter/matter_scenes.hpp"

namespace palpate {

inline std::unique_ptr<MatterSimulation> atRest(const MatterMaker& make, const MatterScene& scene,
                                                std::size_t tools = 0) {
  return make(scene, tools, placesAtRest(scene));
}

/// Grains on a tilted floor, in a box that is periodic along z.
MatterScene sandbox(const DVec3& box_mm, const DVec3& fill_mm, double friction, double tilt_deg);

/// Pressure within 2 %, weight on the floor within 1 %, compression at most 1 %; means over `steps` steps after
/// `settling`.
void checkWaterAtRest(const MatterMaker& make, int settling, int steps);
/// Layers of a channel against the parabola of their viscosity, within 3 % of the highest velocity.
void checkPoiseuille(const MatterMaker& make, double viscosity_Pa_s, int steps);
/// Layers below a plate that begins to move, during the diffusion and in the steady state, within 1 % of its velocity.
void checkCouette(const MatterMaker& make, double viscosity_Pa_s);
/// With these multiples of the required substeps pressure is the same within 2 %, and the front of a dam within 3 %.
void checkWaterByAnySubsteps(const MatterMaker& make, const std::vector<std::uint32_t>& times, int settling, int steps);
/// After each of `steps` steps.
void checkMomentumIsAccountedFor(const MatterMaker& make, int steps);
void checkMomentumStays(const MatterMaker& make, int steps);
void checkWallsHold(const MatterMaker& make, int steps);
/// Both give the same bytes, and again after a reset; with a tool in water, or in sand.
void checkSameBytes(const MatterMaker& one, const MatterMaker& other, Matter matter, int steps);

/// A long block of water in the air, 1 mm apart, with cohesion.
MatterScene floatingBlock(double cohesion_N_m);
/// That block becomes rounder, loses no particle, and keeps its momentum and angular momentum; without cohesion it
/// stays unchanged. After `steps` steps the ratio of length to width is at most `ratio`, from 2.
void checkCohesion(const MatterMaker& make, int steps, double ratio);

/// Buoyancy within 3 % on a ball of that radius; means over `steps` steps after `settling`.
void checkBuoyancy(const MatterMaker& make, double radius_m, int settling, int steps);
/// Hands that move randomly in water or sand extract at most a millijoule, at the given gain of their forces.
void checkRandomHands(const MatterMaker& make, Matter matter, double gain, int hands, int steps);
/// The energy of a hand is the sum over steps of displacement times force, while the gain changes.
void checkPortEnergy(const MatterMaker& make, int steps, double share);
/// The torque on a ball that rotates slowly in a tank of viscous water opposes the spin, and is proportional to spin
/// and viscosity; its mean over the second half of the steps is between these fractions of 8 pi mu R^3 omega. Water
/// gets the opposite.
void checkTorque(const MatterMaker& make, int steps, double least, double most);
void checkReactions(const MatterMaker& make, int steps);

/// A grain on a slope of 30 degrees.
void checkSlope(const MatterMaker& make, double friction);
/// Surface of a bed, `wide_mm` along z, that has slid in a box tilted by 45 degrees: its slope is pi / 2 times the
/// friction (Caquot 1934, "Equilibre des massifs a frottement interne": grains that slide at all contacts and do not
/// rotate). It rests slightly steeper because grains also interlock.
void checkAngleOfRepose(const MatterMaker& make, double friction, double wide_mm, double within_deg);
/// A heap does not creep, and its momentum is accounted for.
void checkHeap(const MatterMaker& make, const DVec3& fill_mm, int falling, int resting);
void checkBallInSand(const MatterMaker& make);

/// A parameter set at the beginning gives the same bytes as the same parameter in the scene.
void checkParametersAreTaken(const MatterMaker& make, int steps);
/// A parameter set during the simulation causes no jump, and momentum is accounted for; a rejected one changes nothing.
void checkParametersKeepMotion(const MatterMaker& make, int steps);

/// A ball without matter around it comes no closer to a sphere than both radii, and feels it.
void checkBallStopsAtModel(const MatterMaker& make);

/// A tank of water or sand with an analytic shape in its centre.
MatterScene modelInTank(std::string_view shape, double size_mm, Matter matter = Matter::water);
std::size_t withinBall(const MatterSimulation& world, const DVec3& middle_m, double radius_m);
/// Force on a sphere in water within 4 % of the weight of the displaced water; means over `steps` steps.
void checkModelDisplaces(const MatterMaker& make, int settling, int steps);
/// Matter that falls onto the scene's model.
void checkModelKeepsOut(const MatterMaker& make, const MatterScene& scene, int steps);
void checkBallBeginsInside(const MatterMaker& make, Matter matter, int steps);

void checkFewParticles(const MatterMaker& make);
void checkDivergence(const MatterMaker& make);
void checkJumpingHand(const MatterMaker& make, int steps);

}  // namespace palpate
