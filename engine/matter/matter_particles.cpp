#include "engine/matter/matter_particles.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shaders/shared/matter.h"

namespace palpate {

namespace {

// Entries of `values` in another order; `scratch` keeps its memory.
template <class T>
void permute(std::vector<T>& values, const std::vector<std::uint32_t>& order, std::vector<T>& scratch) {
  scratch.resize(values.size());
  for (std::size_t k = 0; k < order.size(); ++k) scratch[k] = values[order[k]];
  values.swap(scratch);
}

template <class V>
V wrapped(V place, const MatterBox& box) {
  for (int k = 0; k < 3; ++k)
    if (box.periodic[static_cast<std::size_t>(k)]) place[k] -= box.size[k] * std::floor(place[k] / box.size[k]);
  return place;
}

}  // namespace

MatterParticles::MatterParticles(const Config& config, std::vector<Vec3> places)
    : config_(config), grid_(config.box, config.listed_m), lists_(config.listed_m), positions_(std::move(places)) {
  velocities_.resize(size());
  nextVelocities_.resize(size());
  places_.resize(size());
  ids_.resize(size());
  std::iota(ids_.begin(), ids_.end(), 0u);
  farthest2_.resize(blocksOf(size()));
}

bool MatterParticles::predict(const Vec3& change, WorkerTeam& team) {
  fall_ = change;
  team.forEach(blocksOf(size()), [&](std::size_t block) {
    const std::size_t begin = block * kSlotsOfBlock, end = std::min(begin + kSlotsOfBlock, size());
    float farthest2 = 0;
    for (std::size_t i = begin; i < end; ++i) {
      velocities_[i] += change;
      const Vec3 place = positions_[i] + config_.step_s * velocities_[i];
      places_[i] = Vec4(place, 0);
      if (listedAt_.empty()) continue;
      const Vec3 gone = place - listedAt_[i];
      farthest2 = std::max(farthest2, glm::dot(gone, gone));
    }
    farthest2_[block] = farthest2;
  });
  const float allowed = (config_.listed_m - config_.reach_m) / 2;
  const bool stillGood =
      !listedAt_.empty() && std::ranges::all_of(farthest2_, [&](float gone2) { return gone2 < allowed * allowed; });
  return stillGood || sortAndList(team);
}

bool MatterParticles::sortAndList(WorkerTeam& team) {
  for (std::size_t i = 0; i < size(); ++i) {
    const Vec4 place = wrapped(places_[i], config_.box);
    positions_[i] += Vec3(place - places_[i]);
    places_[i] = place;
  }
  grid_.sort(places_, order_);
  std::vector<Vec4> places;
  std::vector<std::uint32_t> ids;
  permute(places_, order_, places);
  permute(ids_, order_, ids);
  permute(positions_, order_, nextVelocities_);
  permute(velocities_, order_, nextVelocities_);
  listedAt_.assign(size(), Vec3(0));
  for (std::size_t i = 0; i < size(); ++i) listedAt_[i] = Vec3(places_[i]);
  return lists_.build(grid_, places_, team);
}

void MatterParticles::settle(std::size_t slot, const Vec3& change, BlockSums& sums) {
  const float step = config_.step_s, mass = config_.mass_kg;
  const Vec3 place = Vec3(places_[slot]) + step * change;
  Vec3 velocity = velocities_[slot] + change;
  Vec3 inside;
  for (int k = 0; k < 3; ++k) {
    inside[k] = shared::keptInside(place[k], config_.box.size[k], config_.nearest_m,
                                   config_.box.periodic[static_cast<std::size_t>(k)]);
    const float stop = (inside[k] - place[k]) / step;
    velocity[k] += stop;
    sums.wallImpulse[k] -= static_cast<double>(mass) * stop;
  }
  positions_[slot] = inside;
  nextVelocities_[slot] = velocity;
  const DVec3 momentum = static_cast<double>(mass) * DVec3(velocity);
  sums.momentum += momentum;
  sums.kinetic_J += 0.5 * glm::dot(momentum, DVec3(velocity));
}

}  // namespace palpate
