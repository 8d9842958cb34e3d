#include "engine/edit/resample_neighbours.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/widest_lanes.hpp"
#include "shaders/shared/resample.h"

namespace palpate {

namespace {

struct Coordinates {
  const double *x, *y, *z;
};

PALPATE_WIDEST_LANES
void dots(std::size_t count, const Coordinates& a, const DVec3& b, double* dots) {
  const double *ax = a.x, *ay = a.y, *az = a.z;
  const double bx = b.x, by = b.y, bz = b.z;
  for (std::size_t k = 0; k < count; ++k) dots[k] = ax[k] * bx + ay[k] * by + az[k] * bz;
}

PALPATE_WIDEST_LANES
void squares(std::size_t count, const Coordinates& a, double* squares) {
  const double *ax = a.x, *ay = a.y, *az = a.z;
  for (std::size_t k = 0; k < count; ++k) squares[k] = ax[k] * ax[k] + ay[k] * ay[k] + az[k] * az[k];
}

PALPATE_WIDEST_LANES
void sectorsOf(std::size_t count, const Coordinates& a, const Frame3& frame, double* distances, shared::uint* sectors) {
  const double *ax = a.x, *ay = a.y, *az = a.z;
  const double ux = frame.u.x, uy = frame.u.y, uz = frame.u.z, vx = frame.v.x, vy = frame.v.y, vz = frame.v.z;
  for (std::size_t k = 0; k < count; ++k) distances[k] = std::sqrt(ax[k] * ax[k] + ay[k] * ay[k] + az[k] * az[k]);
  for (std::size_t k = 0; k < count; ++k)
    sectors[k] = shared::sectorOf(static_cast<float>(ax[k] * ux + ay[k] * uy + az[k] * uz),
                                  static_cast<float>(ax[k] * vx + ay[k] * vy + az[k] * vz));
}

}  // namespace

ResampleNeighbours::ResampleNeighbours(std::span<const ResampleNeighbour> neighbours)
    : points_(neighbours.begin(), neighbours.end()) {
  std::vector<DVec3> offsets;
  for (const ResampleNeighbour& each : points_) {
    offsets.push_back(each.offset);
    widest_ = std::max(widest_, each.spacing);
  }
  near_ = NearPoints(offsets);
  setNormals();
}

bool ResampleNeighbours::look(const Self& self, std::span<const std::uint32_t> among, std::size_t most) {
  gathered_->near(self.place, self.radius, among, self.number, near_);
  const bool complete = size() <= most;
  near_.truncate(most);
  setNormals();
  return complete;
}

void ResampleNeighbours::setNormals() {
  for (std::vector<double>* each : {&normalX_, &normalY_, &normalZ_, &squared_, &cosine_, &distance_})
    if (each->size() < size()) each->resize(2 * size());
  sectors_.resize(distance_.size());
  for (std::size_t k = 0; k < size(); ++k) {
    const DVec3& normal = points_[near_.indices()[k]].normal;
    normalX_[k] = normal.x;
    normalY_[k] = normal.y;
    normalZ_[k] = normal.z;
  }
}

ResampleNeighbour ResampleNeighbours::operator[](std::size_t k) const {
  ResampleNeighbour neighbour = points_[near_.indices()[k]];
  neighbour.offset = {near_.x()[k], near_.y()[k], near_.z()[k]};
  return neighbour;
}

const double* ResampleNeighbours::squaredDistances() {
  squares(size(), {near_.x(), near_.y(), near_.z()}, squared_.data());
  return squared_.data();
}

const double* ResampleNeighbours::cosines(const DVec3& normal) {
  dots(size(), {normalX_.data(), normalY_.data(), normalZ_.data()}, normal, cosine_.data());
  return cosine_.data();
}

ResampleNeighbours::Sectors ResampleNeighbours::sectors(const Frame3& frame) {
  sectorsOf(size(), {near_.x(), near_.y(), near_.z()}, frame, distance_.data(), sectors_.data());
  return {distance_.data(), sectors_.data()};
}

}  // namespace palpate
