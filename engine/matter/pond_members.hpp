// Which of the particles that somebody else simulates are simulated here, too: those around the balls of the hands.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/matter/known_matter.hpp"
#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// How far from the middle of a ball what happens to a particle, m.
struct PondReach {
  double ball = 0;    ///< its radius
  double within = 0;  ///< what is nearer has no room beside the ball
  double free = 0;    ///< up to here particles are their own
  double held = 0;    ///< from here on they are where they are known to be; in between the more so the farther out
  double end = 0;     ///< beyond that none is here
};
PondReach pondReach(const MatterScene& scene, const MatterPlan& plan);

/// A particle that is simulated here.
struct PondMember {
  std::uint32_t id = 0;
  std::uint32_t was = ~std::uint32_t{0};  ///< its number among those before; kNoParticle: it is new here
  Vec3 place{0}, velocity{0};             ///< m, m/s
  bool isKnown = false;                   ///< it is known where it should be:
  Vec3 knownPlace{0}, heldAt{0};          ///< as it is known now; where it was held when that came
};

/// What PondMembers has to know of the scene.
struct PondSpace {
  PondReach reach;
  float spacing_m = 0;
  float fastest_m_s = 0;  ///< that anything moves
  Vec3 box_m{0};
};

class PondMembers {
 public:
  explicit PondMembers(const PondSpace& space) : space_(space) {}

  /// The members after news: `members`, by ascending id, as they are here by now; `balls`: the middles of the hands'
  /// balls, m; `rests`: whether each of these is at rest. Who is here stays where it is, and keeps its number (`was`);
  /// who comes has its known place where that is free. Where a ball rests as it is known to be - nothing is known to be
  /// within it - and others are about it here than are known to be, these come in their place. False where more are
  /// known than can be in the room that there is; nothing is changed then.
  bool renew(const KnownMatter& known, std::span<const DVec3> balls, std::span<const std::uint8_t> rests,
             std::vector<PondMember>& members) const;

  /// Share by which a particle is held, from 0 to 1, at that distance from the nearest ball.
  float held(float distance) const;
  /// From a place to the middle of the nearest ball.
  static float distance(const Vec3& place, std::span<const DVec3> balls);

 private:
  struct Known;
  std::vector<Known> near(const KnownMatter& known, std::span<const DVec3> balls) const;
  bool differs(const std::vector<Known>& near, const std::vector<PondMember>& members, std::span<const DVec3> balls,
               std::size_t ball) const;
  bool isDisplaced(const PondMember& member, const Vec3& known) const;

  PondSpace space_;
};

}  // namespace palpate
