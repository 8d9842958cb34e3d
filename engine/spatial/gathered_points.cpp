#include "engine/spatial/gathered_points.hpp"

#include "engine/core/widest_lanes.hpp"

namespace palpate {

namespace {

PALPATE_WIDEST_LANES
void squaredDistances(const float* x, const float* y, const float* z, std::size_t count, const DVec3& place,
                      double* squared) {
  const double px = place.x, py = place.y, pz = place.z;
  for (std::size_t i = 0; i < count; ++i) {
    const double dx = double{x[i]} - px, dy = double{y[i]} - py, dz = double{z[i]} - pz;
    squared[i] = dx * dx + dy * dy + dz * dz;
  }
}

}  // namespace

NearPoints::NearPoints(std::span<const DVec3> offsets) {
  makeRoom(offsets.size());
  for (const DVec3& offset : offsets) {
    index_[count_] = static_cast<std::uint32_t>(count_);
    x_[count_] = offset.x;
    y_[count_] = offset.y;
    z_[count_] = offset.z;
    ++count_;
  }
}

void NearPoints::makeRoom(std::size_t count) {
  if (index_.size() >= count) return;
  index_.resize(2 * count);
  for (std::vector<double>* each : {&x_, &y_, &z_, &squared_}) each->resize(2 * count);
}

void GatheredPoints::makeRoom(std::size_t more) {
  const std::size_t room = count_ + more;
  if (numbers_.size() >= room) return;
  for (std::vector<float>* each : {&x_, &y_, &z_}) each->resize(room + room / 4);
  numbers_.resize(room + room / 4);
}

void GatheredPoints::add(const SortedGrid::Placed& point, bool keep) {
  x_[count_] = point.position.x;
  y_[count_] = point.position.y;
  z_[count_] = point.position.z;
  numbers_[count_] = point.number;
  count_ += keep;
}

void GatheredPoints::gather(const SortedGrid& grid, const Balls& balls) {
  count_ = 0;
  if (balls.box.cells() > SortedGrid::kFewCells) {
    grid.forEachNear(balls.low, balls.radius, [&](const SortedGrid::Placed& point) {
      makeRoom(1);
      add(point, true);
    });
    return;
  }
  // Leaves out points that are too far along one axis. Rounding is monotonic, so that their distances to all positions
  // are also computed as too large.
  grid.forEachBucket(balls.box, [&](std::span<const SortedGrid::Placed> points) {
    makeRoom(points.size());
    for (const SortedGrid::Placed& point : points) {
      const DVec3 above = DVec3(point.position) - balls.high, below = balls.low - DVec3(point.position);
      const DVec3 beside = glm::max(above, below);
      add(point, (beside.x < balls.radius) & (beside.y < balls.radius) & (beside.z < balls.radius));
    }
  });
}

void GatheredPoints::near(const DVec3& place, double radius, NearPoints& near) const {
  near.makeRoom(count_);
  squaredDistances(x_.data(), y_.data(), z_.data(), count_, place, near.squared_.data());
  const double squared = radius * radius;
  const double* const distances = near.squared_.data();
  std::uint32_t* const index = near.index_.data();
  std::size_t count = 0;
  for (std::size_t i = 0; i < count_; ++i) {  // without unpredictable branches
    index[count] = static_cast<std::uint32_t>(i);
    count += distances[i] < squared;
  }
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = index[k];
    near.x_[k] = double{x_[i]} - place.x;
    near.y_[k] = double{y_[i]} - place.y;
    near.z_[k] = double{z_[i]} - place.z;
  }
  near.count_ = count;
}

void GatheredPoints::near(const DVec3& place, double radius, std::span<const std::uint32_t> among,
                          std::uint32_t without, NearPoints& near) const {
  near.makeRoom(among.size() + 1);
  const double squared = radius * radius;
  std::size_t count = 0;
  for (const std::uint32_t i : among) {
    const double dx = double{x_[i]} - place.x, dy = double{y_[i]} - place.y, dz = double{z_[i]} - place.z;
    near.index_[count] = i;
    near.x_[count] = dx;
    near.y_[count] = dy;
    near.z_[count] = dz;
    count += (dx * dx + dy * dy + dz * dz < squared) & (numbers_[i] != without);
  }
  near.count_ = count;
}

}  // namespace palpate
