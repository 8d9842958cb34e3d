#include "engine/matter/matter_surface.hpp"

#include <algorithm>

#include "engine/matter/neighbour_lists.hpp"
#include "shaders/shared/matter.h"

namespace palpate {

namespace {

// More than two layers of particles, so that the lattice of their rest state does not show.
constexpr double kReach_spacings = 3;
// Minimum gradient near a surface, about a hundredth of that at a flat surface.
constexpr float kFlat = 0.5f;
// In units of the reach; a particle at the edge of a body has at least kFewest particles that near, including itself.
constexpr float kClose = 0.5f;
constexpr std::uint32_t kFewest = 5;

}  // namespace

MatterSurface::MatterSurface(const MatterBox& box, double spacing_m, unsigned threads)
    : reach_(static_cast<float>(kReach_spacings * spacing_m)), grid_(cellsOf(box, reach_)), team_(threads) {}

void MatterSurface::normalsOf(std::span<const Vec3> places, const Vec3& up, std::vector<Vec3>& normals) {
  places_.resize(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) places_[i] = Vec4(places[i], 0);
  grid_.sort(places_, team_);
  const std::span<const std::uint32_t> order = grid_.order();
  sorted_.resize(places.size());
  for (std::size_t k = 0; k < order.size(); ++k) sorted_[k] = places_[order[k]];
  normals.resize(places.size());
  team_.forEach(blocksOf(places.size()), [&](std::size_t block) {
    const std::size_t begin = block * kSlotsOfBlock, end = std::min(begin + kSlotsOfBlock, places.size());
    for (std::size_t k = begin; k < end; ++k) {
      normals[order[k]] = normalAt(k, up);
    }
  });
}

Vec3 MatterSurface::normalAt(std::size_t slot, const Vec3& up) const {
  const Vec3 place(sorted_[slot]);
  Vec3 sum(0);  // in units of the reach
  std::uint32_t close = 0;
  grid_.forEachRun(place, [&](std::uint32_t begin, std::uint32_t end, std::uint32_t image) {
    const Vec3 seenFrom = place - grid_.shiftOf(image);
    for (std::uint32_t k = begin; k < end; ++k) {
      const Vec3 offset = (seenFrom - Vec3(sorted_[k])) / reach_;
      const float r = glm::length(offset);
      sum += shared::wendlandPull(std::min(r, 1.0f)) * offset;
      close += r < kClose ? 1u : 0u;
    }
  });
  if (close < kFewest) return Vec3(0);
  const float length = glm::length(sum);
  return length > kFlat ? sum / length : up;
}

}  // namespace palpate
