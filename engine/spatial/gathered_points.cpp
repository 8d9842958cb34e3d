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

void GatheredPoints::add(const SortedGrid::Placed& point, bool keep) {
  x_[count_] = point.position.x;
  y_[count_] = point.position.y;
  z_[count_] = point.position.z;
  numbers_[count_] = point.number;
  count_ += keep;
}

void GatheredPoints::gather(const SortedGrid& grid, const Balls& balls) {
  count_ = 0;
  const auto makeRoom = [&](std::size_t more) {
    const std::size_t room = count_ + more;
    if (numbers_.size() >= room) return;
    for (std::vector<float>* each : {&x_, &y_, &z_}) each->resize(2 * room);
    for (std::vector<double>* each : {&squared_, &offsetX_, &offsetY_, &offsetZ_}) each->resize(2 * room);
    for (std::vector<std::uint32_t>* each : {&numbers_, &near_}) each->resize(2 * room);
  };
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

GatheredPoints::Near GatheredPoints::near(const DVec3& place, double radius, std::uint32_t without) {
  squaredDistances(x_.data(), y_.data(), z_.data(), count_, place, squared_.data());
  const double squared = radius * radius;
  std::size_t count = 0;
  for (std::size_t i = 0; i < count_; ++i) {  // without unpredictable branches
    near_[count] = static_cast<std::uint32_t>(i);
    count += (squared_[i] < squared) & (numbers_[i] != without);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = near_[k];
    offsetX_[k] = double{x_[i]} - place.x;
    offsetY_[k] = double{y_[i]} - place.y;
    offsetZ_[k] = double{z_[i]} - place.z;
  }
  return {count, near_.data(), offsetX_.data(), offsetY_.data(), offsetZ_.data()};
}

}  // namespace palpate
