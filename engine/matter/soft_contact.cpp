#include "engine/matter/soft_contact.hpp"

#include <algorithm>

namespace palpate {

namespace {

// Positions per work item of a thread: all, and those near something.
constexpr std::size_t kPlacesOfBlock = 256, kNearOfBlock = 64;

template <class Visit>
void forEachCorner(const SoftLattice& lattice, const SkinPlace& place, Visit&& visit) {
  const SoftLattice::Corners& nodes = lattice.corners()[place.at.cell];
  for (int k = 0; k < 8; ++k) visit(nodes[static_cast<std::size_t>(k)], shared::cornerShare(place.at.share, k));
}

}  // namespace

std::vector<SkinPlace> skinOf(const SoftLattice& lattice, std::span<const float> masses,
                              std::span<const SurfacePlace> surface, double frequency_rad_s) {
  std::vector<SkinPlace> places;
  places.reserve(surface.size());
  std::vector<float> sharesOfNode(lattice.nodes(), 0);
  for (const SurfacePlace& at : surface) {
    const SkinPlace& place =
        places.emplace_back(SkinPlace{.at = lattice.embed(DVec3(at.rest)), .rest = at.rest, .normal = at.normal});
    forEachCorner(lattice, place, [&](std::uint32_t node, float share) { sharesOfNode[node] += share; });
  }
  // By the Cauchy-Schwarz inequality: each position's share of a node times the sum of all positions' shares of it.
  const double square = frequency_rad_s * frequency_rad_s;
  for (SkinPlace& place : places) {
    double perMass = 0;
    forEachCorner(lattice, place, [&](std::uint32_t node, float share) {
      perMass += static_cast<double>(share * sharesOfNode[node] / masses[node]);
    });
    place.stiffness = static_cast<float>(square / perMass);
  }
  return places;
}

SoftContact::SoftContact(const SoftBody& body, std::span<const SurfacePlace> surface, const Config& config)
    : config_(config),
      reach_m_(static_cast<float>(body.lattice().spacing_m() / 2)),
      places_(skinOf(body.lattice(), body.masses(), surface, config.frequency_rad_s)) {}

void SoftContact::change(const Config& config) {
  const double times = config.frequency_rad_s / config_.frequency_rad_s;
  for (SkinPlace& place : places_) place.stiffness *= static_cast<float>(times * times);
  config_ = config;
}

SoftContact::Moved SoftContact::now(const SoftBody& body, const SkinPlace& place) const {
  Vec3 moved(0), velocity(0);
  forEachCorner(body.lattice(), place, [&](std::uint32_t node, float share) {
    moved += share * body.displacements()[node];
    velocity += share * body.velocities()[node];
  });
  return {.place = place.rest + moved, .velocity = velocity};
}

shared::SoftTouch SoftContact::touchOf(const SkinPlace& place) const {
  return {.stiffness = place.stiffness,
          .damping = static_cast<float>(kTouchDamping / config_.frequency_rad_s) * place.stiffness,
          .friction = static_cast<float>(config_.friction)};
}

bool SoftContact::isNear(const SoftBody& body, const SkinPlace& place, std::span<const BodyMotion> balls,
                         double duration_s) const {
  const Moved moved = now(body, place);
  const float wallReach = reach_m_ + static_cast<float>(duration_s) * glm::length(moved.velocity);
  const Vec3 fromWall = glm::min(moved.place, Vec3(config_.box_m) - moved.place);
  if (!(std::min({fromWall.x, fromWall.y, fromWall.z}) > wallReach)) return true;
  return std::ranges::any_of(balls, [&](const BodyMotion& ball) {
    const float reach = wallReach + static_cast<float>(config_.ball_m + duration_s * glm::length(ball.velocity));
    const Vec3 offset = moved.place - Vec3(ball.place);
    return glm::dot(offset, offset) < reach * reach;
  });
}

void SoftContact::list(const SoftBody& body, std::span<const BodyMotion> balls, double duration_s, WorkerTeam& team) {
  isNear_.resize(places_.size());
  team.forEach((places_.size() + kPlacesOfBlock - 1) / kPlacesOfBlock, [&](std::size_t block) {
    const std::size_t end = std::min((block + 1) * kPlacesOfBlock, places_.size());
    for (std::size_t i = block * kPlacesOfBlock; i < end; ++i)
      isNear_[i] = isNear(body, places_[i], balls, duration_s) ? 1 : 0;
  });
  near_.clear();
  for (std::uint32_t i = 0; i < places_.size(); ++i)
    if (isNear_[i] != 0) near_.push_back(i);
}

void SoftContact::press(SoftBody& body, std::span<const BodyMotion> balls, double step_s, DVec3& wallImpulse,
                        std::span<Exchange> exchanges, WorkerTeam& team) {
  const auto radius = static_cast<float>(config_.ball_m);
  byWalls_.resize(near_.size());
  byBalls_.resize(near_.size() * balls.size());
  team.forEach((near_.size() + kNearOfBlock - 1) / kNearOfBlock, [&](std::size_t block) {
    const std::size_t end = std::min((block + 1) * kNearOfBlock, near_.size());
    for (std::size_t n = block * kNearOfBlock; n < end; ++n) {
      const SkinPlace& place = places_[near_[n]];
      const Moved moved = now(body, place);
      byWalls_[n] = shared::wallsForce(touchOf(place), Vec3(config_.box_m), moved.place, moved.velocity);
      for (std::size_t b = 0; b < balls.size(); ++b) {
        const Vec3 offset(DVec3(moved.place) - balls[b].place);
        const Vec3 ofBall(balls[b].velocity + glm::cross(balls[b].spin, DVec3(offset)));
        byBalls_[n * balls.size() + b] = {
            .force = shared::ballForce(touchOf(place), radius, offset, moved.velocity - ofBall), .offset = offset};
      }
    }
  });
  // Sums in the order of the positions.
  for (std::size_t n = 0; n < near_.size(); ++n) {
    Vec3 force = byWalls_[n];
    wallImpulse -= step_s * DVec3(force);
    for (std::size_t b = 0; b < balls.size(); ++b) {
      const ByBall& part = byBalls_[n * balls.size() + b];
      if (part.force == Vec3(0)) continue;
      exchanges[b].add(-step_s * DVec3(part.force), DVec3(part.offset));
      force += part.force;
    }
    if (force == Vec3(0)) continue;
    forEachCorner(body.lattice(), places_[near_[n]],
                  [&](std::uint32_t node, float share) { body.loads()[node] += share * force; });
  }
}

void SoftContact::addWallStiffness(const SoftBody& body, std::span<const DVec3> changes,
                                   std::span<DVec3> forces) const {
  for (const std::uint32_t i : near_) {
    const SkinPlace& place = places_[i];
    DVec3 change(0);
    forEachCorner(body.lattice(), place,
                  [&](std::uint32_t node, float share) { change += static_cast<double>(share) * changes[node]; });
    const Vec3 depths = shared::depthsInWalls(now(body, place).place, Vec3(config_.box_m));
    for (int axis = 0; axis < 3; ++axis) {
      if (depths[axis] == 0) continue;
      forEachCorner(body.lattice(), place, [&](std::uint32_t node, float share) {
        forces[node][axis] += static_cast<double>(share * place.stiffness) * change[axis];
      });
    }
  }
}

}  // namespace palpate
