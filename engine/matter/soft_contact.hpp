// Where a soft body's surface meets the walls of its box and the balls that hands hold.
#pragma once

#include <span>
#include <vector>

#include "engine/matter/boundary.hpp"
#include "engine/matter/matter_particles.hpp"
#include "engine/matter/soft_body.hpp"

namespace palpate {

/// A place of the surface, and how stiff it is to what presses on it.
struct SkinPlace {
  EmbeddedPlace at;
  Vec3 rest{0};
  Vec3 normal{0};       ///< at rest
  float stiffness = 0;  ///< N/m
};

/// As stiff as may be while all springs together have no higher frequency than that (rad/s), whatever the nodes of
/// those masses (kg) do.
std::vector<SkinPlace> skinOf(const SoftLattice& lattice, std::span<const float> masses,
                              std::span<const SurfacePlace> surface, double frequency_rad_s);

/// Each place of the surface is a spring and a damper to what presses on it (shaders/shared/soft.h); its force goes to
/// the nodes of its cell by its share of them, so that nothing is lost between them, and the energy of the spring is
/// one of the nodes' places. No place pulls, and what is beyond the surface altogether is not felt: a ball of less than
/// a spacing's radius would slip between places.
class SoftContact {
 public:
  struct Config {
    DVec3 box_m{0};              ///< walls from 0 to there
    double ball_m = 0;           ///< radius of the balls
    double frequency_rad_s = 0;  ///< touchFrequency()
    double friction = 0;         ///< Coulomb's coefficient, of walls and balls
  };
  SoftContact(const SoftBody& body, std::span<const SurfacePlace> surface, const Config& config);

  /// Of another material from now on; the box and the balls are the same.
  void change(const Config& config);

  /// Looks which places may meet walls or balls within `duration_s`.
  void list(const SoftBody& body, std::span<const BodyMotion> balls, double duration_s, WorkerTeam& team);
  /// Loads the body for a substep with what walls and balls do to the listed places. Adds to `wallImpulse`, and to
  /// `exchanges`, one a ball, what the body does to them, kg m/s.
  void press(SoftBody& body, std::span<const BodyMotion> balls, double step_s, DVec3& wallImpulse,
             std::span<Exchange> exchanges);

  /// What listed places that stand on walls take away from `forces` where the nodes go on by `changes` (m), N.
  void addWallStiffness(const SoftBody& body, std::span<const DVec3> changes, std::span<DVec3> forces) const;

 private:
  struct Moved {
    Vec3 place{0}, velocity{0};
  };
  bool isNear(const SoftBody& body, const SkinPlace& place, std::span<const BodyMotion> balls, double duration_s) const;
  Moved now(const SoftBody& body, const SkinPlace& place) const;
  shared::SoftTouch touchOf(const SkinPlace& place) const;

  Config config_;
  float reach_m_;  // so far beside what may be met within no time at all places are listed
  std::vector<SkinPlace> places_;
  std::vector<char> isNear_;         // of each place
  std::vector<std::uint32_t> near_;  // the places that are, ascending
};

}  // namespace palpate
