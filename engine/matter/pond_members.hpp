// Selection of remote particles that are simulated locally: those around the balls of the hands.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/matter/known_matter.hpp"
#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// Zones around a ball, as distances from its centre, m.
struct PondReach {
  double ball = 0;    ///< radius of the ball
  double within = 0;  ///< nearer particles would overlap the ball
  double free = 0;    ///< up to here particles move freely
  double held = 0;  ///< from here on particles are held at their known positions; in between increasingly with distance
  double end = 0;   ///< no members beyond
};
PondReach pondReach(const MatterScene& scene, const MatterPlan& plan);

/// A particle that is simulated locally.
struct PondMember {
  std::uint32_t id = 0;
  std::uint32_t was = ~std::uint32_t{0};  ///< its previous number; kNoParticle: new member
  Vec3 place{0}, velocity{0};             ///< m, m/s
  bool isKnown = false;                   ///< its position is known:
  Vec3 knownPlace{0}, heldAt{0};          ///< its present known position; its held position when that arrived
};

/// Properties of the scene for PondMembers.
struct PondSpace {
  PondReach reach;
  float spacing_m = 0;
  float fastest_m_s = 0;  ///< maximum speed
  Vec3 box_m{0};
};

class PondMembers {
 public:
  explicit PondMembers(const PondSpace& space) : space_(space) {}

  /// Updates `members` (ascending ids, at their present positions) after an update of the known state. `balls`: centres
  /// of the hands' balls, m; `rests`: whether each of them is at rest. Members keep their positions and numbers
  /// (`was`); new ones start at their known position if that is free. If a ball rests where it is known to be - no
  /// known particle is inside it - and the local particles around it differ from the known ones, the known ones replace
  /// them. False, with nothing changed, if more particles are known than the space can hold.
  bool renew(const KnownMatter& known, std::span<const DVec3> balls, std::span<const std::uint8_t> rests,
             std::vector<PondMember>& members) const;

  /// Share (0 to 1) by which a particle is held at a distance from the nearest ball.
  float held(float distance) const;
  /// Distance from a position to the centre of the nearest ball.
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
