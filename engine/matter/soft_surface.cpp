#include "engine/matter/soft_surface.hpp"

#include <algorithm>
#include <limits>

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

}  // namespace palpate
