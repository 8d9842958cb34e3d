// Contact of a soft body's surface with the walls of its box and the balls held by hands.
#pragma once

#include <span>
#include <vector>

#include "engine/matter/boundary.hpp"
#include "engine/matter/matter_particles.hpp"
#include "engine/matter/soft_body.hpp"

namespace palpate {

/// A position of the surface, and its contact stiffness.
struct SkinPlace {
  EmbeddedPlace at;
  Vec3 rest{0};
  Vec3 normal{0};       ///< at rest
  float stiffness = 0;  ///< N/m
};

/// The stiffest springs whose combined frequency does not exceed `frequency_rad_s`, for any motion of nodes with these
/// masses (kg).
std::vector<SkinPlace> skinOf(const SoftLattice& lattice, std::span<const float> masses,
                              std::span<const SurfacePlace> surface, double frequency_rad_s);

/// Each position of the surface is a spring and a damper to what presses on it (shaders/shared/soft.h); its force is
/// distributed to the nodes of its cell by their shares, so that momentum is conserved, and the spring's energy depends
/// only on the nodes' positions. Forces never pull, and objects entirely inside the surface are not felt: a ball with a
/// radius below a spacing could slip between positions.
class SoftContact {
 public:
  struct Config {
    DVec3 box_m{0};              ///< walls from 0 to this corner
    double ball_m = 0;           ///< radius of the balls
    double frequency_rad_s = 0;  ///< touchFrequency()
    double friction = 0;         ///< Coulomb's coefficient, of walls and balls
  };
  SoftContact(const SoftBody& body, std::span<const SurfacePlace> surface, const Config& config);

  /// Sets the properties of another material; the box and the balls stay.
  void change(const Config& config);

  /// Lists the positions that may touch walls or balls within `duration_s`.
  void list(const SoftBody& body, std::span<const BodyMotion> balls, double duration_s, WorkerTeam& team);
  /// Adds the forces of walls and balls on the listed positions to the body's loads for a substep. Adds the body's
  /// impulses on them to `wallImpulse`, and to `exchanges`, one per ball, kg m/s.
  void press(SoftBody& body, std::span<const BodyMotion> balls, double step_s, DVec3& wallImpulse,
             std::span<Exchange> exchanges, WorkerTeam& team);

  /// Adds to `forces` (N) the decrease of the walls' forces on the listed positions if the nodes move by `changes` (m).
  void addWallStiffness(const SoftBody& body, std::span<const DVec3> changes, std::span<DVec3> forces) const;

 private:
  struct Moved {
    Vec3 place{0}, velocity{0};
  };
  // Force on a position, and where that is relative to the centre of the ball.
  struct ByBall {
    Vec3 force{0}, offset{0};
  };
  bool isNear(const SoftBody& body, const SkinPlace& place, std::span<const BodyMotion> balls, double duration_s) const;
  Moved now(const SoftBody& body, const SkinPlace& place) const;
  shared::SoftTouch touchOf(const SkinPlace& place) const;

  Config config_;
  float reach_m_;  // margin of the list around walls and balls, besides motion
  std::vector<SkinPlace> places_;
  std::vector<char> isNear_;         // per position
  std::vector<std::uint32_t> near_;  // the near positions, ascending
  std::vector<Vec3> byWalls_;        // force on each of these
  std::vector<ByBall> byBalls_;      // by each ball
};

}  // namespace palpate
