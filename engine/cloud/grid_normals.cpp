#include "engine/cloud/grid_normals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr double kSteepest = 10;   // tangent of the largest angle of incidence at which a surface gets a normal
constexpr double kMinJump = 0.01;  // relative to the distance
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

class Grid {
 public:
  Grid(std::span<const Vec3> places, const SensorGrid& grid)
      : places_(places), grid_(grid), at_(std::size_t{grid.width} * grid.height, kNone) {
    for (std::size_t i = 0; i < places.size(); ++i) at_[grid.cells[i]] = static_cast<std::uint32_t>(i);
  }

  Vec3 normalOf(std::size_t i) const {
    const std::uint32_t cell = grid_.cells[i], column = cell % grid_.width, row = cell / grid_.width;
    const DVec3 place = fromSensor(i);
    const auto across =
        way(place, column > 0 ? at_[cell - 1] : kNone, column + 1 < grid_.width ? at_[cell + 1] : kNone);
    const auto down =
        way(place, row > 0 ? at_[cell - grid_.width] : kNone, row + 1 < grid_.height ? at_[cell + grid_.width] : kNone);
    if (!across || !down) return Vec3(0);
    const DVec3 normal = glm::cross(*down, *across);
    const double size = glm::length(normal);
    if (!(size > 0) || !std::isfinite(size)) return Vec3(0);
    return Vec3(normal * (glm::dot(normal, place) > 0 ? -1 / size : 1 / size));
  }

 private:
  DVec3 fromSensor(std::size_t i) const { return DVec3(places_[i]) - grid_.sensor; }
  bool isSameSurface(const DVec3& place, const DVec3& other) const {
    const double far = glm::length(place), otherFar = glm::length(other);
    if (!(far > 0) || !(otherFar > 0)) return false;
    const double step = glm::distance(place / far, other / otherFar);
    return std::abs(otherFar - far) <= std::max(kMinJump, kSteepest * step) * far;
  }
  // Difference from the previous to the next ray, where they see the same surface.
  std::optional<DVec3> way(const DVec3& place, std::uint32_t before, std::uint32_t behind) const {
    const auto seen = [&](std::uint32_t i) -> std::optional<DVec3> {
      if (i == kNone || !isSameSurface(place, fromSensor(i))) return std::nullopt;
      return fromSensor(i);
    };
    const auto from = seen(before), to = seen(behind);
    if (!from && !to) return std::nullopt;
    return to.value_or(place) - from.value_or(place);
  }

  std::span<const Vec3> places_;
  const SensorGrid& grid_;
  std::vector<std::uint32_t> at_;  // index of the position in each cell
};

}  // namespace

std::vector<Vec3> gridNormals(std::span<const Vec3> places, const SensorGrid& grid) {
  const std::uint64_t cells = std::uint64_t{grid.width} * grid.height;
  if (grid.cells.size() != places.size() || (!grid.cells.empty() && grid.cells.back() >= cells))
    throw Error("{} positions in {} cells of a grid of {} x {}", places.size(), grid.cells.size(), grid.width,
                grid.height);
  const Grid seen(places, grid);
  std::vector<Vec3> normals(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) normals[i] = seen.normalOf(i);
  return normals;
}

}  // namespace palpate
