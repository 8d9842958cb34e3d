// What matter has to be true to, whoever simulates it. Each makes its own simulations and checks them.
#pragma once

#include "tests/matter/matter_scenes.hpp"

namespace palpate {

inline std::unique_ptr<MatterSimulation> atRest(const MatterMaker& make, const MatterScene& scene,
                                                std::size_t tools = 0) {
  return make(scene, tools, placesAtRest(scene));
}

/// Grains on a floor that is tilted, in a box that is periodic along z.
MatterScene sandbox(const DVec3& box_mm, const DVec3& fill_mm, double friction, double tilt_deg);

/// Pressure within 2 %, weight on the floor within 1 %, compression of 1 % at most; means over some steps after others.
void checkWaterAtRest(const MatterMaker& make, int settling, int steps);
/// Layers of a channel against the parabola of their viscosity, within 3 % of the highest velocity.
void checkPoiseuille(const MatterMaker& make, double viscosity_Pa_s, int steps);
/// Layers below a plate that begins to move, while their motion spreads and at last, within 1 % of its velocity.
void checkCouette(const MatterMaker& make, double viscosity_Pa_s);
/// With so many times the substeps that are needed pressure is the same within 2 %, and the front of a dam within 3 %.
void checkWaterByAnySubsteps(const MatterMaker& make, const std::vector<std::uint32_t>& times, int settling, int steps);
/// After each of so many steps.
void checkMomentumIsAccountedFor(const MatterMaker& make, int steps);
void checkMomentumStays(const MatterMaker& make, int steps);
void checkWallsHold(const MatterMaker& make, int steps);
/// The same bytes by both, and again after a reset; with a tool in water, or in sand.
void checkSameBytes(const MatterMaker& one, const MatterMaker& other, Matter matter, int steps);

/// A long block of water in the air, 1 mm apart, with cohesion.
MatterScene floatingBlock(double cohesion_N_m);
/// That block becomes rounder, none of it is lost, and it has the momentum and the angular momentum that it had;
/// without cohesion it stays as it is. After so many steps its length over its width is at most `ratio`, of 2.
void checkCohesion(const MatterMaker& make, int steps, double ratio);

/// Buoyancy within 3 %, on a ball of that radius; means over some steps after others.
void checkBuoyancy(const MatterMaker& make, double radius_m, int settling, int steps);
/// Hands that go anywhere in water or sand get no more than a millijoule out, with the gain of their forces.
void checkRandomHands(const MatterMaker& make, Matter matter, double gain, int hands, int steps);
/// The energy of a hand is the sum over steps of what it moved against the force that it got, while the gain changes.
void checkPortEnergy(const MatterMaker& make, int steps, double share);
/// What turns a ball that goes round slowly in a tank full of viscous water is against the spin, and goes with that and
/// with viscosity; of 8 pi mu R^3 omega it is such a share, a mean over the second half of the steps. Water gets the
/// opposite.
void checkTorque(const MatterMaker& make, int steps, double least, double most);
void checkReactions(const MatterMaker& make, int steps);

/// A grain on a slope of 30 degrees.
void checkSlope(const MatterMaker& make, double friction);
/// Surface of a bed, `wide_mm` along z, that has slid in a box tilted by 45 degrees: its slope is pi / 2 times the
/// friction (Caquot 1934, "Equilibre des massifs a frottement interne": grains that slide at all contacts, and do not
/// turn). It rests a little steeper, as grains lock, too.
void checkAngleOfRepose(const MatterMaker& make, double friction, double wide_mm, double within_deg);
/// Does not creep, and keeps its momentum's account.
void checkHeap(const MatterMaker& make, const DVec3& fill_mm, int falling, int resting);
void checkBallInSand(const MatterMaker& make);

/// The same bytes with a parameter from the beginning on as where it is set then.
void checkParametersAreTaken(const MatterMaker& make, int steps);
/// Where one is set in mid-run nothing jumps, and momentum is accounted for; what is refused changes nothing.
void checkParametersKeepMotion(const MatterMaker& make, int steps);

/// A ball without matter about it goes no nearer to a sphere than the two radii, and feels that.
void checkBallStopsAtModel(const MatterMaker& make);

/// A tank of water or sand with an analytic shape in the middle of it.
MatterScene modelInTank(std::string_view shape, double size_mm, Matter matter = Matter::water);
std::size_t withinBall(const MatterSimulation& world, const DVec3& middle_m, double radius_m);
/// Force on a sphere that stands in water within 4 % of the weight of what it displaces; means over some steps.
void checkModelDisplaces(const MatterMaker& make, int settling, int steps);
/// Matter that falls upon the model of the scene.
void checkModelKeepsOut(const MatterMaker& make, const MatterScene& scene, int steps);
void checkBallBeginsInside(const MatterMaker& make, Matter matter, int steps);

void checkFewParticles(const MatterMaker& make);
void checkDivergence(const MatterMaker& make);
void checkJumpingHand(const MatterMaker& make, int steps);

}  // namespace palpate
