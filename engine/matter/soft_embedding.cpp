#include "engine/matter/soft_embedding.hpp"

#include <algorithm>

namespace palpate {

namespace {

constexpr std::size_t kPointsOfBlock = 1024;

}  // namespace

SoftEmbedding::SoftEmbedding(const SoftLattice& lattice, std::span<const SurfacePlace> points)
    : rest_(points.begin(), points.end()) {
  places_.reserve(points.size());
  for (const SurfacePlace& point : points) places_.push_back(lattice.embed(DVec3(point.rest)));
}

void SoftEmbedding::carry(const SoftBody& body, CloudFrame& frame, WorkerTeam& team) {
  body.gradients(gradients_, team);
  frame.positions.resize(size());
  frame.normals.resize(size());
  frame.velocities.resize(size());
  team.forEach((size() + kPointsOfBlock - 1) / kPointsOfBlock, [&](std::size_t block) {
    const std::size_t end = std::min((block + 1) * kPointsOfBlock, size());
    for (std::size_t i = block * kPointsOfBlock; i < end; ++i) {
      const SoftLattice::Corners& nodes = body.lattice().corners()[places_[i].cell];
      Vec3 moved(0), velocity(0);
      glm::mat3 gradient(0);
      for (int k = 0; k < 8; ++k) {
        const float share = shared::cornerShare(places_[i].share, k);
        const std::uint32_t node = nodes[static_cast<std::size_t>(k)];
        moved += share * body.displacements()[node];
        velocity += share * body.velocities()[node];
        gradient += share * gradients_[node];
      }
      frame.positions[i] = rest_[i].rest + moved;
      frame.velocities[i] = velocity;
      frame.normals[i] = shared::unitNormalCarried(gradient, rest_[i].normal);
    }
  });
}

}  // namespace palpate
