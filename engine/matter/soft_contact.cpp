#include "engine/matter/soft_contact.hpp"

#include <algorithm>

namespace palpate {

namespace {

// A node's share of a place that is less is that of rounding.
constexpr float kLeastShare = 1e-5f;

}  // namespace

SoftContact::SoftContact(const SoftBody& body, std::span<const SurfacePlace> surface, const Config& config)
    : config_(config), reach_m_(static_cast<float>(body.lattice().spacing_m() / 2)) {
  const SoftLattice& lattice = body.lattice();
  std::vector<float> sharesOfNode(lattice.nodes(), 0);
  const auto forEachNode = [&](const Place& place, auto&& visit) {
    for (int k = 0; k < 8; ++k) {
      const float share = shared::cornerShare(place.at.share, k);
      if (share > kLeastShare) visit(lattice.corners()[place.at.cell][static_cast<std::size_t>(k)], share);
    }
  };
  for (const SurfacePlace& at : surface) {
    Place& place = places_.emplace_back(Place{.at = lattice.embed(DVec3(at.rest)), .rest = at.rest});
    forEachNode(place, [&](std::uint32_t node, float share) { sharesOfNode[node] += share; });
  }
  // So stiff that the springs of no node, all together, have more than the frequency: a place's share of a node's motion
  // squared is below the share of the square (Jensen).
  const auto square = static_cast<float>(config.frequency_rad_s * config.frequency_rad_s);
  for (Place& place : places_) {
    float least = static_cast<float>(body.mass_kg());
    forEachNode(place, [&](std::uint32_t node, float) {
      least = std::min(least, body.masses()[node] / sharesOfNode[node]);
    });
    place.stiffness = square * least;
  }
}

SoftContact::Moved SoftContact::now(const SoftBody& body, const Place& place) const {
  const SoftLattice::Corners& nodes = body.lattice().corners()[place.at.cell];
  Vec3 moved(0), velocity(0);
  for (int k = 0; k < 8; ++k) {
    const float share = shared::cornerShare(place.at.share, k);
    moved += share * body.displacements()[nodes[static_cast<std::size_t>(k)]];
    velocity += share * body.velocities()[nodes[static_cast<std::size_t>(k)]];
  }
  return {.place = place.rest + moved, .velocity = velocity};
}

void SoftContact::load(SoftBody& body, const Place& place, const Vec3& force) const {
  const SoftLattice::Corners& nodes = body.lattice().corners()[place.at.cell];
  for (int k = 0; k < 8; ++k)
    body.loads()[nodes[static_cast<std::size_t>(k)]] += shared::cornerShare(place.at.share, k) * force;
}

shared::SoftTouch SoftContact::touchOf(const Place& place) const {
  return {.stiffness = place.stiffness,
          .damping = static_cast<float>(kTouchDamping / config_.frequency_rad_s) * place.stiffness,
          .friction = static_cast<float>(config_.friction)};
}

void SoftContact::list(const SoftBody& body, std::span<const BodyMotion> balls, double duration_s) {
  const auto duration = static_cast<float>(duration_s);
  const Vec3 box(config_.box_m);
  near_.clear();
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    const Moved moved = now(body, places_[i]);
    const float wallReach = reach_m_ + duration * glm::length(moved.velocity);
    const Vec3 fromWall = glm::min(moved.place, box - moved.place);
    bool isNear = !(std::min({fromWall.x, fromWall.y, fromWall.z}) > wallReach);
    for (const BodyMotion& ball : balls) {
      const float reach = wallReach + static_cast<float>(config_.ball_m + duration_s * glm::length(ball.velocity));
      const Vec3 offset = moved.place - Vec3(ball.place);
      isNear |= glm::dot(offset, offset) < reach * reach;
    }
    if (isNear) near_.push_back(i);
  }
}

Vec3 SoftContact::forceOfWalls(const Place& place, const Moved& moved) const {
  Vec3 force(0);
  for (int axis = 0; axis < 3; ++axis) {
    const float low = -moved.place[axis], high = moved.place[axis] - static_cast<float>(config_.box_m[axis]);
    const float depth = std::max(low, high);
    if (!(depth > 0)) continue;
    Vec3 normal(0);
    normal[axis] = low > high ? 1.0f : -1.0f;
    force += shared::touchForce(touchOf(place), normal, depth, moved.velocity);
  }
  return force;
}

void SoftContact::press(SoftBody& body, std::span<const BodyMotion> balls, double step_s, DVec3& wallImpulse,
                        std::span<Exchange> exchanges) {
  const auto radius = static_cast<float>(config_.ball_m);
  for (const std::uint32_t i : near_) {
    const Place& place = places_[i];
    const Moved moved = now(body, place);
    Vec3 force = forceOfWalls(place, moved);
    wallImpulse -= step_s * DVec3(force);
    for (std::size_t b = 0; b < balls.size(); ++b) {
      const Vec3 offset(DVec3(moved.place) - balls[b].place);
      const float away = glm::length(offset);
      if (!(away < radius && away > 0)) continue;
      const Vec3 ofBall(balls[b].velocity + glm::cross(balls[b].spin, DVec3(offset)));
      const Vec3 part = shared::touchForce(touchOf(place), offset / away, radius - away, moved.velocity - ofBall);
      exchanges[b].add(-step_s * DVec3(part), DVec3(offset));
      force += part;
    }
    if (force != Vec3(0)) load(body, place, force);
  }
}

}  // namespace palpate
