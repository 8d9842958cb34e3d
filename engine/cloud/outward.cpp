#include "engine/cloud/outward.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "engine/core/parallel.hpp"

namespace palpate {
namespace {

constexpr float kSparse = 3;             // times the median reach: such points float about
constexpr double kCell = 2;              // median reaches; sixteen neighbours have a mean distance of 1.5 spacings
constexpr double kAbove = 5;             // votes of a point that is seen from above
constexpr double kBalanced = 0.05;       // of all votes
constexpr std::size_t kLarge = 1 << 14;  // points; for fewer, threads cost more than they save
constexpr std::uint32_t kEmpty = std::numeric_limits<std::uint32_t>::max();

/// Cells of a depth map along one axis: their size, and where they begin.
struct Cells {
  double side = 1;
  DVec3 min{0};
  std::array<std::size_t, 3> count{1, 1, 1};

  /// At most about as many cells in a map as there are points.
  Cells(std::span<const FacingPoint> points, double wanted) {
    DVec3 low(points.front().position), high = low;
    for (const FacingPoint& point : points) {
      low = glm::min(low, DVec3(point.position));
      high = glm::max(high, DVec3(point.position));
    }
    const DVec3 size = high - low;
    const double area = std::max({size.x * size.y, size.y * size.z, size.z * size.x});
    const double longest = std::max({size.x, size.y, size.z});
    const auto most = static_cast<double>(points.size());
    side = std::max({wanted, std::sqrt(area / most), longest / most});
    if (!(side > 0)) side = 1;
    min = low;
    for (int axis = 0; axis < 3; ++axis) count[axis] = static_cast<std::size_t>(size[axis] / side) + 1;
  }
  std::size_t along(int axis, const Vec3& p) const {
    return static_cast<std::size_t>((double{p[axis]} - min[axis]) / side);
  }
};

/// Votes for the normals as they are, from the negative and the positive direction of an axis: sums of the shares of
/// the normals of the points in front that face the viewer.
std::array<double, 2> seenAlong(int axis, std::span<const FacingPoint> points, const Cells& cells) {
  const int across = (axis + 1) % 3, down = (axis + 2) % 3;
  std::vector<std::array<std::uint32_t, 2>> front(cells.count[across] * cells.count[down], {kEmpty, kEmpty});
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i].position;
    auto& [lowest, highest] = front[cells.along(down, p) * cells.count[across] + cells.along(across, p)];
    if (lowest == kEmpty || p[axis] < points[lowest].position[axis]) lowest = i;
    if (highest == kEmpty || p[axis] > points[highest].position[axis]) highest = i;
  }
  std::array<double, 2> seen{};
  for (const auto& [lowest, highest] : front) {
    if (lowest == kEmpty) continue;
    seen[0] -= points[lowest].normal[axis];
    seen[1] += points[highest].normal[axis];
  }
  return seen;
}

void dropSparse(BareVector<FacingPoint>& surface) {
  std::vector<float> reaches;
  reaches.reserve(surface.size());
  for (const FacingPoint& point : surface) reaches.push_back(point.reach);
  const auto middle = reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2);
  std::ranges::nth_element(reaches, middle);
  std::erase_if(surface, [most = kSparse * *middle](const FacingPoint& point) { return point.reach > most; });
}

}  // namespace

bool facesInwards(BareVector<FacingPoint> surface, UpAxis up, unsigned threads) {
  if (surface.empty()) return false;
  dropSparse(surface);
  double reach = 0;
  for (const FacingPoint& point : surface) reach += double{point.reach};
  const Cells cells(surface, kCell * reach / static_cast<double>(surface.size()));
  std::array<std::array<double, 2>, 3> seen;
  const unsigned used = surface.size() < kLarge ? 1 : threads;
  parallelBlocks(3, 1, used, [&](std::size_t axis, std::size_t) {
    seen[axis] = seenAlong(static_cast<int>(axis), surface, cells);
  });
  const DVec3 above = directionOf(up), front = frontOf(up);
  double votes = 0, all = 0, facing = 0;
  DVec3 sum(0);
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const double weight = above[axis] * (side ? 1 : -1) > 0 ? kAbove : 1;
      votes += weight * seen[axis][side];
      all += weight * std::abs(seen[axis][side]);
    }
  if (std::abs(votes) > kBalanced * all) return votes < 0;
  for (const FacingPoint& point : surface) sum += DVec3(point.normal);
  const auto most = static_cast<double>(surface.size());
  facing = glm::dot(sum, front);
  if (std::abs(facing) > kBalanced * most) return facing < 0;
  const DVec3 third = glm::abs(glm::cross(above, front));
  return glm::dot(sum, third) < 0;
}

}  // namespace palpate
