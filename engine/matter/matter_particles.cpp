#include "engine/matter/matter_particles.hpp"

#include <algorithm>
#include <numeric>

namespace palpate {

namespace {

const Vec4 kNowhere_m(1e18f, 1e18f, 1e18f, 0);

// Permutes as many values as there are in `order`; `scratch` has as many values as `values`.
template <class T>
void permute(std::vector<T>& values, std::span<const std::uint32_t> order, std::vector<T>& scratch) {
  for (std::size_t k = 0; k < order.size(); ++k) scratch[k] = values[order[k]];
  values.swap(scratch);
}

}  // namespace

MatterParticles::MatterParticles(const Config& config, std::vector<Vec3> places)
    : config_(config),
      walls_{.size = config.box.size,
             .nearest = config.nearest_m,
             .step = config.step_s,
             .openX = config.box.periodic[0],
             .openY = config.box.periodic[1],
             .openZ = config.box.periodic[2]},
      grid_(cellsOf(config.box, config.listed_m)),
      lists_(config.listed_m),
      positions_(std::move(places)) {
  for (std::vector<Vec4>* const read : {&places_, &sortedPlaces_, &pressed_}) read->assign(size() + 1, kNowhere_m);
  for (std::vector<Vec4>* const velocities : {&velocities_, &nextVelocities_}) velocities->assign(size() + 1, Vec4(0));
  sortedPositions_.resize(size());
  sortedIds_.resize(size());
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
  grid_.sort(places(), team);
  permute(places_, grid_.order(), sortedPlaces_);
  permute(ids_, grid_.order(), sortedIds_);
  permute(positions_, grid_.order(), sortedPositions_);
  permute(velocities_, grid_.order(), nextVelocities_);
  listedAt_.assign(size(), Vec3(0));
  for (std::size_t i = 0; i < size(); ++i) listedAt_[i] = Vec3(places_[i]);
  return lists_.build(grid_, places(), team);
}

void MatterParticles::keepOutOfModel(std::size_t slot, const Vec3& byModel, BlockSums& sums) {
  const double mass = config_.mass_kg;
  const MatterModel& model = *config_.model;
  const Vec3 place = positions_[slot], out = keptOut(model.field(), model.at(place)) / config_.step_s;
  sums.model.add(-mass * DVec3(byModel + out), DVec3(place) - model.middle());
  if (out == Vec3(0)) return;
  const auto settled = shared::settle<float>(walls_, place, Vec3(nextVelocities_[slot]), out);
  sums.wallImpulse -= mass * DVec3(settled.stop);
  positions_[slot] = settled.place;
  nextVelocities_[slot] = Vec4(settled.velocity, 0);
}

}  // namespace palpate
