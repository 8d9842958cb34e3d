#include "engine/matter/pond_members.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "engine/matter/cell_grid.hpp"
#include "engine/matter/matter_law.hpp"
#include "engine/matter/matter_rules.hpp"

namespace palpate {

namespace {

// Distances beyond a ball, in spacings. Held particles up to a support radius before the end have neighbours on all
// sides.
constexpr double kHeld_spacings = 3.5, kEnd_spacings = kHeld_spacings + kSupport_spacings;
// Held grains do not yield at all, so they need a wider free zone; otherwise a ball that is ahead of the known state
// finds them too hard.
constexpr double kWaterFree_spacings = 1.5, kSandFree_spacings = 1.75;
// Distance of matter from a ball: grains touch its points, water is pressed a little nearer.
constexpr double kWaterBeside_spacings = 0.25, kSandBeside_spacings = 0.5;
// A particle farther from its known position is not held there.
constexpr float kDisplaced_spacings = 1.5f;
// Minimum distance between a new member and another one.
constexpr float kApart_spacings = 0.85f;
// Maximum share of the particles around a ball that may differ from the known ones.
constexpr double kMisfit = 0.02;
// Members stay up to this distance, in units of the end distance.
constexpr float kLeaves = 1.03f;
// Maximum density relative to that at rest; more is invalid.
constexpr double kMaxDense = 1.5;

std::size_t nearestOf(const Vec3& place, std::span<const DVec3> balls) {
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < balls.size(); ++k)
    if (glm::distance(DVec3(place), balls[k]) < glm::distance(DVec3(place), balls[nearest])) nearest = k;
  return nearest;
}

// Tests whether positions are free; earlier members keep theirs.
class TakenPlaces {
 public:
  TakenPlaces(const PondSpace& space, const std::vector<PondMember>& members)
      : apart_m_(kApart_spacings * space.spacing_m),
        grid_(cellsOf({.size = space.box_m}, static_cast<float>(kReach_spacings) * space.spacing_m)) {
    std::vector<Vec4> places;
    places.reserve(members.size());
    for (const PondMember& member : members) places.emplace_back(member.place, 0);
    WorkerTeam alone(1);
    grid_.sort(places, alone);
    for (const std::uint32_t k : grid_.order()) sorted_.push_back(Vec3(places[k]));
  }
  bool isFree(const Vec3& place) const {
    bool free = true;
    grid_.forEachRun(place, [&](std::uint32_t begin, std::uint32_t end, std::uint32_t) {
      for (std::uint32_t k = begin; k < end; ++k) free = free && glm::distance(sorted_[k], place) >= apart_m_;
    });
    return free;
  }

 private:
  float apart_m_;
  CellGrid grid_;
  std::vector<Vec3> sorted_;
};

}  // namespace

PondReach pondReach(const MatterScene& scene, const MatterPlan& plan) {
  const double radius = scene.tool.radius_mm * 1e-3, spacing = plan.spacing_m;
  const bool isSand = scene.matter == Matter::sand;
  const double beside = isSand ? kSandBeside_spacings : kWaterBeside_spacings;
  const double free = isSand ? kSandFree_spacings : kWaterFree_spacings;
  return {.ball = radius,
          .within = radius + beside * spacing,
          .free = radius + free * spacing,
          .held = radius + kHeld_spacings * spacing,
          .end = radius + kEnd_spacings * spacing};
}

// A known particle within reach of a ball.
struct PondMembers::Known {
  std::uint32_t id = 0;
  Vec3 place{0}, velocity{0};
  float distance = 0;
  std::size_t ball = 0;  // index of the nearest ball
};

float PondMembers::held(float distance) const {
  const auto free = static_cast<float>(space_.reach.free), held = static_cast<float>(space_.reach.held);
  const float x = std::clamp((distance - free) / (held - free), 0.0f, 1.0f);
  return x * x * (3 - 2 * x);
}

float PondMembers::distance(const Vec3& place, std::span<const DVec3> balls) {
  return balls.empty() ? std::numeric_limits<float>::infinity()
                       : static_cast<float>(glm::distance(DVec3(place), balls[nearestOf(place, balls)]));
}

std::vector<PondMembers::Known> PondMembers::near(const KnownMatter& known, std::span<const DVec3> balls) const {
  std::vector<Known> near;
  if (balls.empty()) return near;
  for (std::size_t i = 0; i < known.size(); ++i) {
    Vec3 velocity = known.velocities[i];
    if (!(glm::length(velocity) <= space_.fastest_m_s)) velocity = Vec3(0);
    const Vec3& place = known.positions[i];
    const bool isInBox =
        glm::all(glm::greaterThanEqual(place, Vec3(0))) && glm::all(glm::lessThanEqual(place, space_.box_m));
    const std::size_t ball = nearestOf(place, balls);
    const auto distance = static_cast<float>(glm::distance(DVec3(place), balls[ball]));
    if (!isInBox || !(distance < space_.reach.end)) continue;
    near.push_back({known.ids[i], place, velocity, distance, ball});
  }
  return near;
}

// Whether a ball is where it is known to be, and the local particles around it differ from the known ones.
bool PondMembers::differs(const std::vector<Known>& near, const std::vector<PondMember>& members,
                          std::span<const DVec3> balls, std::size_t ball) const {
  std::size_t known = 0, other = 0;
  const auto isAbout = [&](const PondMember& member) {
    return nearestOf(member.place, balls) == ball &&
           glm::distance(DVec3(member.place), balls[ball]) < space_.reach.held;
  };
  auto member = members.begin();
  for (const Known& one : near) {
    for (; member != members.end() && member->id < one.id; ++member) other += isAbout(*member);
    const bool isHere = member != members.end() && member->id == one.id;
    if (one.ball == ball && one.distance < space_.reach.free) {
      if (one.distance < space_.reach.ball) return false;
      ++known;
      other += !isHere || isDisplaced(*member, one.place);
    }
    if (isHere) ++member;
  }
  return static_cast<double>(other) > kMisfit * static_cast<double>(known);
}

bool PondMembers::isDisplaced(const PondMember& member, const Vec3& known) const {
  return glm::distance(member.place, known) > kDisplaced_spacings * space_.spacing_m;
}

bool PondMembers::renew(const KnownMatter& known, std::span<const DVec3> balls, std::span<const std::uint8_t> rests,
                        std::vector<PondMember>& members) const {
  const std::vector<Known> near = this->near(known, balls);
  const double room =
      4.0 / 3 * std::numbers::pi * std::pow(space_.reach.end / space_.spacing_m, 3) * static_cast<double>(balls.size());
  if (static_cast<double>(near.size()) > kMaxDense * room) return false;
  std::vector<std::uint8_t> exchanged(balls.size());
  for (std::size_t k = 0; k < balls.size(); ++k) exchanged[k] = rests[k] && differs(near, members, balls, k);

  std::vector<PondMember> kept, coming;
  const auto come = [&](const Known& one, std::uint32_t was) {
    coming.push_back({.id = one.id,
                      .was = was,
                      .place = one.place,
                      .velocity = one.velocity,
                      .isKnown = true,
                      .knownPlace = one.place,
                      .heldAt = one.place});
  };
  auto there = near.begin();
  for (PondMember& member : members) {
    for (; there != near.end() && there->id < member.id; ++there) come(*there, kNoParticle);
    const float far = distance(member.place, balls);
    const bool isKnown = there != near.end() && there->id == member.id;
    const bool isToMove = isKnown && exchanged[there->ball];
    if (isToMove) {
      come(*there, member.was);
    } else if (far < kLeaves * space_.reach.end &&
               !(far < space_.reach.held && exchanged[nearestOf(member.place, balls)])) {
      // A displaced particle stays where it is: all are alike, and it had room there.
      if (!member.isKnown) member.heldAt = member.place;
      member.isKnown = isKnown && !isDisplaced(member, there->place);
      if (member.isKnown) member.knownPlace = there->place;
      kept.push_back(member);
    }
    if (isKnown) ++there;
  }
  for (; there != near.end(); ++there) come(*there, kNoParticle);

  const TakenPlaces taken(space_, kept);
  std::erase_if(coming, [&](const PondMember& one) {
    const bool isWithin = distance(one.place, balls) < space_.reach.within && !exchanged[nearestOf(one.place, balls)];
    return isWithin || !taken.isFree(one.place);
  });
  members.clear();
  std::ranges::merge(kept, coming, std::back_inserter(members), {}, &PondMember::id, &PondMember::id);
  return true;
}

}  // namespace palpate
