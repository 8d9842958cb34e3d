// Required accuracy of a soft body, for any implementation. Each check makes its own simulations.
#pragma once

#include "engine/matter/soft_lattice.hpp"
#include "tests/matter/matter_scenes.hpp"

namespace palpate {

/// Makes a simulation of a soft body with the implementation under test; a null `solid` selects the scene's shape.
using SoftMaker = std::function<std::unique_ptr<MatterSimulation>(
    const MatterScene& scene, std::size_t tools, const SoftSolid* solid, std::span<const SurfacePlace> points)>;
/// Sets the displacement of every node from rest, m.
using SoftBend = std::function<void(MatterSimulation& world, std::span<const Vec3> displacements)>;

SoftMaker softOnCpu(unsigned threads = 2);
SoftBend bendOnCpu();

/// A block of 50 x 40 x 50 mm on the floor, for a hand with a ball.
MatterScene softBlock();
/// Sized in spacings of 5 mm, far from all walls, held at its low end along x, without gravity.
MatterScene softBar(const DVec3& spacings);

/// Its own weight extends it by rho g L^2 / 2 E, within 2 %.
void checkHangingBar(const SoftMaker& make, const DVec3& spacings, double poisson);
/// Its own weight bends it by w L^4 / 8 E I plus shear (Timoshenko), within 4 %.
void checkCantilever(const SoftMaker& make, const DVec3& spacings);
/// It oscillates longitudinally at the frequency of its wave, within 1 %, over `rounds` periods.
void checkStretchFrequency(const SoftMaker& make, const DVec3& spacings, int rounds);
/// A ball in a hand, pressed into a block by a tenth of its radius.
struct HertzCase {
  int width, height;  ///< of the block, cells
  int ball;           ///< radius, spacings
  double poisson;
  double within;
};
/// The force equals that of Hertz.
void checkHertz(const SoftMaker& make, const HertzCase& one);
/// A rotation by up to 3.1 rad causes no stress, to 1e-5 of that of a strain of 1.
void checkTurned(const SoftMaker& make, const SoftBend& bend);
/// After each of `steps` steps in which it falls and bounces, to 1e-5; then the same with tools and pins.
void checkSoftMomentum(const SoftMaker& make, int steps);
/// The body loses the momentum that a ball gains, to 1e-5, and the hand feels that, after `down` steps of descent and
/// `staying` steps at rest.
void checkSoftReactions(const SoftMaker& make, int down, int staying);
/// Pressed for `pressed` steps, and back at rest within a micrometre after `free` steps.
void checkReturn(const SoftMaker& make, int pressed, int free);
/// The energy of each hand is at least -1 mJ.
void checkSoftPortEnergy(const SoftMaker& make, int hands, int steps);
/// Both give the same bytes, and again after a reset; so are the frames.
void checkSameSoftBytes(const SoftMaker& one, const SoftMaker& other, int steps);
/// A diverged simulation reports it, gives no force from then on, and can be reset.
void checkSoftDivergence(const SoftMaker& make);
/// A hand that jumps gives a bounded force or ends the simulation.
void checkSoftJump(const SoftMaker& make, int steps);
/// A body that begins with a parameter and one that receives it behave the same.
void checkSoftParameters(const SoftMaker& make, int steps);
/// Displacements of pinned nodes stay 0.
void checkPinsHold(const SoftMaker& make, int steps);

}  // namespace palpate
