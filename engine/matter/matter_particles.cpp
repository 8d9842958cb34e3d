#include "engine/matter/matter_particles.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shaders/shared/matter.h"

namespace palpate {

namespace {

// Permutes `values`; `scratch` keeps its memory.
template <class T>
void permute(std::vector<T>& values, std::span<const std::uint32_t> order, std::vector<T>& scratch) {
  scratch.resize(values.size());
  for (std::size_t k = 0; k < order.size(); ++k) scratch[k] = values[order[k]];
  values.swap(scratch);
}

}  // namespace

MatterParticles::MatterParticles(const Config& config, std::vector<Vec3> places)
    : config_(config),
      grid_(cellsOf(config.box, config.listed_m)),
      lists_(config.listed_m),
      positions_(std::move(places)) {
  velocities_.resize(size());
  nextVelocities_.resize(size());
  places_.resize(size());
  pressed_.resize(size());
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
      velocities_[i] += Vec4(change, 0);
      const Vec3 place = positions_[i] + config_.step_s * Vec3(velocities_[i]);
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
    const Vec3 place = wrapped(grid_.cells(), Vec3(places_[i]));
    positions_[i] += place - Vec3(places_[i]);
    places_[i] = Vec4(place, 0);
  }
  grid_.sort(places_, team);
  permute(places_, grid_.order(), sortedPlaces_);
  permute(ids_, grid_.order(), sortedIds_);
  permute(positions_, grid_.order(), sortedPositions_);
  permute(velocities_, grid_.order(), nextVelocities_);
  listedAt_.assign(size(), Vec3(0));
  for (std::size_t i = 0; i < size(); ++i) listedAt_[i] = Vec3(places_[i]);
  return lists_.build(grid_, places_, team);
}

shared::StoppingWalls MatterParticles::walls() const {
  return {.size = config_.box.size,
          .nearest = config_.nearest_m,
          .step = config_.step_s,
          .openX = config_.box.periodic[0],
          .openY = config_.box.periodic[1],
          .openZ = config_.box.periodic[2]};
}

void MatterParticles::settle(std::size_t slot, const Vec3& change, const Vec3& byModel, BlockSums& sums) {
  const Vec3 yielded = (1 - velocities_[slot].w) * change;
  shared::Settled settled = shared::settle<float>(walls(), Vec3(places_[slot]), Vec3(velocities_[slot]), yielded);
  const double mass = config_.mass_kg;
  sums.wallImpulse -= mass * DVec3(settled.stop);
  if (config_.model != nullptr) {
    const MatterModel& model = *config_.model;
    const Vec3 out = keptOut(model.field(), model.at(settled.place)) / config_.step_s;
    sums.model.add(-mass * DVec3(byModel + out), DVec3(settled.place) - model.middle());
    if (out != Vec3(0)) {
      settled = shared::settle<float>(walls(), settled.place, settled.velocity, out);
      sums.wallImpulse -= mass * DVec3(settled.stop);
    }
  }
  positions_[slot] = settled.place;
  nextVelocities_[slot] = Vec4(settled.velocity, 0);
  const DVec3 momentum = mass * DVec3(settled.velocity);
  sums.momentum += momentum;
  sums.kinetic_J += 0.5 * glm::dot(momentum, DVec3(settled.velocity));
}

}  // namespace palpate
