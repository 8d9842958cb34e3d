// What a soft body has to be true to, whoever simulates it. Each makes its own simulations and checks them.
#pragma once

#include "engine/matter/soft_lattice.hpp"
#include "tests/matter/matter_scenes.hpp"

namespace palpate {

/// Makes a simulation of a soft body on what is tested: of the scene's own shape where `solid` is null.
using SoftMaker = std::function<std::unique_ptr<MatterSimulation>(
    const MatterScene& scene, std::size_t tools, const SoftSolid* solid, std::span<const SurfacePlace> points)>;
/// Puts every node so far from rest, m.
using SoftBend = std::function<void(MatterSimulation& world, std::span<const Vec3> displacements)>;

SoftMaker softOnCpu(unsigned threads = 2);
SoftBend bendOnCpu();

/// A block of 50 x 40 x 50 mm on the floor, for a hand with a ball.
MatterScene softBlock();
/// Of so many spacings of 5 mm, far from all walls, held at its low end along x, without gravity.
MatterScene softBar(const DVec3& spacings);

/// Longer by its own weight by rho g L^2 / 2 E, within 2 %.
void checkHangingBar(const SoftMaker& make, const DVec3& spacings, double poisson);
/// Bent by its own weight by w L^4 / 8 E I and what shear adds (Timoshenko), within 4 %.
void checkCantilever(const SoftMaker& make, const DVec3& spacings);
/// Swings along itself with the frequency of its wave, within 1 %, for so many rounds.
void checkStretchFrequency(const SoftMaker& make, const DVec3& spacings, int rounds);
/// A ball in a hand and the block that it is pressed into by a tenth of its radius.
struct HertzCase {
  int width, height;  ///< of the block, cells
  int ball;           ///< radius, spacings
  double poisson;
  double within;
};
/// It is pushed back as Hertz says.
void checkHertz(const SoftMaker& make, const HertzCase& one);
/// A turn by up to 3.1 rad makes no stress, to 1e-5 of that of a strain of 1.
void checkTurned(const SoftMaker& make, const SoftBend& bend);
/// After each of so many steps in which it falls and bounces, to 1e-5; then the same with tools and pins.
void checkSoftMomentum(const SoftMaker& make, int steps);
/// What a ball got is what the body lost, to 1e-5, and the hand feels that: after so many steps of coming down and of
/// staying there.
void checkSoftReactions(const SoftMaker& make, int down, int staying);
/// Pressed for so many steps, and back at rest within a micrometre after others.
void checkReturn(const SoftMaker& make, int pressed, int free);
/// At least -1 mJ.
void checkSoftPortEnergy(const SoftMaker& make, int hands, int steps);
/// The same bytes by both, and again after a reset; so are frames.
void checkSameSoftBytes(const SoftMaker& one, const SoftMaker& other, int steps);
/// Says so, has no force from then on, and can be begun again.
void checkSoftDivergence(const SoftMaker& make);
/// A hand that jumps gives a bounded force or ends the simulation.
void checkSoftJump(const SoftMaker& make, int steps);
/// Those that begin with a parameter go as those that are given it.
void checkSoftParameters(const SoftMaker& make, int steps);
/// Those of nodes that are pinned stay 0.
void checkPinsHold(const SoftMaker& make, int steps);

}  // namespace palpate
