#include "engine/matter/soft_press.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "shaders/shared/weight.h"

namespace palpate {

namespace {

constexpr std::size_t kPlacesOfBlock = 512;  // positions per work item of a thread

}  // namespace

SoftSurface::SoftSurface(const SoftLattice& lattice, std::span<const SurfacePlace> surface)
    : rest_(surface.begin(), surface.end()) {
  embedded_.reserve(surface.size());
  for (const SurfacePlace& place : surface) embedded_.push_back(lattice.embed(DVec3(place.rest)));
}

Vec3 SoftSurface::placeOf(const SoftBody& body, std::size_t i) const {
  Vec3 place = rest_[i].rest;
  forEachNode(body, i, [&](std::uint32_t node, float share) { place += share * body.displacements()[node]; });
  return place;
}

Vec3 SoftSurface::normalOf(const SoftBody& body, std::size_t i) const {
  return shared::unitNormalCarried(body.gradientOf(embedded_[i].cell), rest_[i].normal);
}

std::uint32_t SoftSurface::nearest(const SoftBody& body, const DVec3& place_m) const {
  std::uint32_t found = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < size(); ++i) {
    const double away = glm::distance(DVec3(placeOf(body, i)), place_m);
    if (away < least) least = away, found = i;
  }
  return found;
}

std::vector<DVec3> SoftSurface::spread(const SoftBody& body, const DVec3& place_m, double radius_m,
                                       const DVec3& direction) const {
  std::vector<DVec3> forces(body.size(), DVec3(0));
  std::vector<std::uint32_t> within;
  for (std::uint32_t i = 0; i < size(); ++i)
    if (glm::distance(DVec3(placeOf(body, i)), place_m) < radius_m) within.push_back(i);
  if (within.empty()) within.push_back(nearest(body, place_m));
  for (const std::uint32_t i : within)
    forEachNode(body, i, [&](std::uint32_t node, float share) {
      forces[node] += static_cast<double>(share) / static_cast<double>(within.size()) * direction;
    });
  return forces;
}

void SoftSurface::places(const SoftBody& body, std::vector<Vec3>& now, WorkerTeam& team) const {
  now.resize(size());
  team.forEach((size() + kPlacesOfBlock - 1) / kPlacesOfBlock, [&](std::size_t block) {
    for (std::size_t i = block * kPlacesOfBlock; i < std::min((block + 1) * kPlacesOfBlock, size()); ++i)
      now[i] = placeOf(body, i);
  });
}

SoftPress::SoftPress(const SoftBody& body, const SoftSurface& surface)
    : surface_(surface), now_(surface.size()), shares_(body.size(), 0) {}

void SoftPress::begin(const SoftBody& body, std::span<const SurfacePress> presses, double duration_s,
                      WorkerTeam& team) {
  const std::vector<Hold> before = std::exchange(holds_, {});
  const std::vector<Held> heldBefore = std::exchange(held_, {});
  duration_s_ = duration_s;
  reports_.assign(presses.size(), {});
  if (presses.empty()) return;
  surface_.places(body, now_, team);
  for (const SurfacePress& press : presses) {
    const std::size_t i = holds_.size();
    const bool goesOn = i < before.size() && before[i].press.hand == press.hand;
    Hold& now = holds_.emplace_back(
        Hold{.press = press, .hand = press.handFrom_m, .force = goesOn ? before[i].force : DVec3(0)});
    const auto old = std::ranges::find_if(before, [&](const Hold& hold) { return hold.press.touch == press.touch; });
    if (press.isSamePlace && old != before.end())
      holdOn(body, now, *old, heldBefore);
    else
      hold(body, now);
  }
}

void SoftPress::holdOn(const SoftBody& body, Hold& hold, const Hold& before, std::span<const Held> heldBefore) {
  hold.first = held_.size();
  for (const Held& held : heldBefore.subspan(before.first, before.last - before.first))
    held_.push_back({.node = held.node, .share = held.share, .began = body.displacements()[held.node]});
  hold.last = held_.size();
  hold.perMass = before.perMass;
  hold.isAlone = before.isAlone;
}

void SoftPress::hold(const SoftBody& body, Hold& hold) {
  hold.first = held_.size();
  const auto radius = static_cast<float>(hold.press.radius_m);
  const Vec3 middle(hold.press.place_m);
  float nearest2 = std::numeric_limits<float>::max();
  std::size_t nearest = 0;
  const auto take = [&](std::size_t i, float weight) {
    if (!(weight > 0)) return;
    surface_.forEachNode(body, i, [&](std::uint32_t node, float share) {
      if (shares_[node] == 0) held_.push_back({.node = node, .share = 0, .began = body.displacements()[node]});
      // Positive even if a position is on the face of its cell, so that a node is added only once.
      shares_[node] += std::max(weight * share, std::numeric_limits<float>::min());
    });
  };
  const auto facing = [&](std::size_t i) {
    return shared::facingWeight(glm::dot(surface_.normalOf(body, i), Vec3(hold.press.normal)));
  };
  for (std::size_t i = 0; i < now_.size(); ++i) {
    const Vec3 offset = now_[i] - middle;
    const float away2 = glm::dot(offset, offset);
    if (away2 < nearest2) nearest2 = away2, nearest = i;
    if (away2 < radius * radius) take(i, facing(i) * shared::wendland(std::sqrt(away2) / radius));
  }
  hold.isAlone = held_.size() == hold.first;
  if (hold.isAlone) take(nearest, 1);
  hold.last = held_.size();
  float all = 0;  // sum of the nodes' shares; it can differ from the weights for positions outside all cells
  for (std::size_t k = hold.first; k < hold.last; ++k) all += shares_[held_[k].node];
  for (std::size_t k = hold.first; k < hold.last; ++k) {
    Held& held = held_[k];
    held.share = shares_[held.node] / all;
    shares_[held.node] = 0;
    if (!body.isPinned(held.node))
      hold.perMass += static_cast<double>(held.share) * static_cast<double>(held.share / body.masses()[held.node]);
  }
}

DVec3 SoftPress::movedBy(const SoftBody& body, const Hold& hold) const {
  DVec3 moved(0);
  for (std::size_t k = hold.first; k < hold.last; ++k)
    moved += static_cast<double>(held_[k].share) * DVec3(body.displacements()[held_[k].node] - held_[k].began);
  return moved;
}

DVec3 SoftPress::velocityAfter(const SoftBody& body, const Hold& hold, const Substep& substep) const {
  DVec3 velocity(0);
  for (std::size_t k = hold.first; k < hold.last; ++k) {
    const std::uint32_t node = held_[k].node;
    if (body.isPinned(node)) continue;
    const DVec3 force(body.forceOn(node));
    velocity += static_cast<double>(held_[k].share) *
                (DVec3(body.velocities()[node]) +
                 substep.length_s * (force / static_cast<double>(body.masses()[node]) + substep.gravity));
  }
  return velocity;
}

// Implicit Euler for the position, from the force already in the loads to the one at the end of the substep.
DVec3 SoftPress::forceOnHand(const SoftBody& body, const Hold& hold, const Substep& substep) const {
  const SurfacePress& press = hold.press;
  const DVec3 hand = glm::mix(press.handFrom_m, press.handTo_m, substep.share);
  const DVec3 handVelocity = (press.handTo_m - press.handFrom_m) / duration_s_;
  const DVec3 velocity = velocityAfter(body, hold, substep);
  const DVec3 stretch = press.place_m + movedBy(body, hold) + substep.length_s * velocity - hand;
  const double answered =
      substep.length_s * (press.stiffness_N_m * substep.length_s + press.damping_N_s_m) * hold.perMass;
  const DVec3 force =
      (press.stiffness_N_m * stretch + press.damping_N_s_m * (velocity - handVelocity) + answered * hold.force) /
      (1 + answered);
  const double push = glm::dot(force, press.normal);
  if (!(push > 0)) return DVec3(0);
  const DVec3 along = force - push * press.normal;
  const double drag = glm::length(along), most = press.friction * push;
  return push * press.normal + (drag > most ? most / drag : 1.0) * along;
}

void SoftPress::loadMore(SoftBody& body, const Hold& hold, const DVec3& onHand) const {
  for (std::size_t k = hold.first; k < hold.last; ++k) body.loads()[held_[k].node] -= held_[k].share * Vec3(onHand);
}

// Limits the total force of a hand's presses to its maximum.
void SoftPress::limit(SoftBody& body) {
  for (std::size_t i = 0; i < holds_.size();) {
    std::size_t end = i;
    DVec3 sum(0);
    for (; end < holds_.size() && holds_[end].press.hand == holds_[i].press.hand; ++end) sum += holds_[end].force;
    const double size = glm::length(sum), most = holds_[i].press.most_N;
    for (; i < end; ++i) {
      if (!(size > most)) continue;
      const DVec3 limited = most / size * holds_[i].force;
      loadMore(body, holds_[i], limited - holds_[i].force);
      holds_[i].force = limited;
    }
  }
}

void SoftPress::load(SoftBody& body, double share, double substep_s, const DVec3& gravity_m_s2) {
  const Substep substep{.share = share, .length_s = substep_s, .gravity = gravity_m_s2};
  for (const Hold& hold : holds_) loadMore(body, hold, hold.force);
  for (Hold& hold : holds_) {
    const DVec3 force = forceOnHand(body, hold, substep);
    loadMore(body, hold, force - hold.force);
    hold.force = force;
  }
  limit(body);
  for (std::size_t i = 0; i < holds_.size(); ++i) {
    Hold& hold = holds_[i];
    const DVec3 hand = glm::mix(hold.press.handFrom_m, hold.press.handTo_m, share);
    reports_[i].impulse += substep_s * hold.force;
    reports_[i].work_J -= glm::dot(hold.force, hand - hold.hand);
    reports_[i].force_N = hold.force;
    hold.hand = hand;
  }
}

void SoftPress::end(const SoftBody& body) {
  for (std::size_t i = 0; i < holds_.size(); ++i) {
    reports_[i].place_m = holds_[i].press.place_m + movedBy(body, holds_[i]);
    reports_[i].isAlone = holds_[i].isAlone;
  }
}

}  // namespace palpate
