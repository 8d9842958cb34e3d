#include "engine/cloud/outward.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>

#include "engine/core/parallel.hpp"

namespace palpate {
namespace {

constexpr float kSparse = 3;             // times the median reach: such points float about
constexpr double kCell = 2;              // median reaches; sixteen neighbours have a mean distance of 1.5 spacings
constexpr double kAbove = 5;             // votes of a point that is seen from above
constexpr double kBalanced = 0.05;       // of all votes
constexpr std::size_t kLarge = 1 << 14;  // points; for fewer, threads cost more than they save
// Of a room: its walls are within kAtWall of the box's extent from its sides and have the share kWalls of the points,
// five of them kWall each. Its contents are farther than kInside from all sides, are behind a wall as seen from
// outside, and have a share of kContents.
constexpr double kAtWall = 0.06, kWalls = 0.5, kWall = 0.02, kInside = 0.08, kContents = 0.02;
constexpr int kFewestWalls = 5;
constexpr double kFlat = 0.9;       // cosine: a normal that is along an axis
constexpr double kFromWall = 0.2;   // mean share of the normals of contents that face the nearest wall
constexpr double kOutside = 0.002;  // share of the points that may be beyond a wall
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

/// The points in front along an axis, from its negative and its positive direction.
using Fronts = std::vector<std::array<std::uint32_t, 2>>;

std::size_t columnOf(int axis, const Vec3& p, const Cells& cells) {
  const int across = (axis + 1) % 3, down = (axis + 2) % 3;
  return cells.along(down, p) * cells.count[across] + cells.along(across, p);
}

Fronts frontsAlong(int axis, std::span<const FacingPoint> points, const Cells& cells) {
  Fronts fronts(cells.count[(axis + 1) % 3] * cells.count[(axis + 2) % 3], {kEmpty, kEmpty});
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i].position;
    auto& [lowest, highest] = fronts[columnOf(axis, p, cells)];
    if (lowest == kEmpty || p[axis] < points[lowest].position[axis]) lowest = i;
    if (highest == kEmpty || p[axis] > points[highest].position[axis]) highest = i;
  }
  return fronts;
}

/// Votes for the normals as they are, from the negative and the positive direction of an axis: sums of the shares of
/// the normals of the points in front that face the viewer.
std::array<double, 2> votesAlong(int axis, std::span<const FacingPoint> points, const Fronts& fronts) {
  std::array<double, 2> seen{};
  for (const auto& [lowest, highest] : fronts) {
    if (lowest == kEmpty) continue;
    seen[0] -= points[lowest].normal[axis];
    seen[1] += points[highest].normal[axis];
  }
  return seen;
}

/// The box of every `step`-th point, without a few that are far out.
Bounds innerBounds(std::span<const FacingPoint> surface, std::size_t step) {
  std::vector<float> along((surface.size() + step - 1) / step);
  const auto outside = static_cast<std::ptrdiff_t>(kOutside * static_cast<double>(along.size()));
  Bounds box;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < along.size(); ++i) along[i] = surface[i * step].position[axis];
    const auto low = along.begin() + outside, high = along.end() - 1 - outside;
    std::ranges::nth_element(along, low);
    box.min[axis] = double{*low};
    std::ranges::nth_element(along, high);
    box.max[axis] = double{*high};
  }
  return box;
}

/// Whether a surface that faces out, as its sides show, is a room that was scanned from inside: most of it is flat
/// walls on nearly all sides of its box, and what is behind these faces them, since it was scanned from the middle.
/// `sign`: -1 if the normals are those of the other side.
bool isRoom(std::span<const FacingPoint> surface, const Cells& cells, const std::array<Fronts, 3>& fronts,
            double sign) {
  constexpr std::size_t kEnough = 1 << 18;  // points
  const std::size_t step = std::max<std::size_t>(1, surface.size() / kEnough);
  const Bounds box = innerBounds(surface, step);
  const DVec3 size = box.max - box.min;
  if (!(std::min({size.x, size.y, size.z}) > 0)) return false;
  const auto fromSide = [&](const Vec3& p, std::size_t side) {  // of the size
    const int axis = static_cast<int>(side / 2);
    const double below = (double{p[axis]} - box.min[axis]) / size[axis];
    return side % 2 ? 1 - below : below;
  };
  std::array<std::size_t, 6> walls{};
  std::size_t contents = 0;
  double towardsWall = 0;
  for (std::size_t i = 0; i < surface.size(); i += step) {
    const Vec3& p = surface[i].position;
    std::array<double, 6> shares, distances;
    for (std::size_t side = 0; side < 6; ++side) {
      shares[side] = fromSide(p, side);
      distances[side] = shares[side] * size[static_cast<int>(side / 2)];
    }
    const auto nearest = static_cast<std::size_t>(std::ranges::min_element(distances) - distances.begin());
    const int axis = static_cast<int>(nearest / 2);
    const double out = sign * (nearest % 2 ? 1 : -1) * double{surface[i].normal[axis]};
    walls[nearest] += shares[nearest] < kAtWall && out > kFlat;
    if (*std::ranges::min_element(shares) < kInside) continue;
    const std::uint32_t front = fronts[nearest / 2][columnOf(axis, p, cells)][nearest % 2];
    if (fromSide(surface[front].position, nearest) > kAtWall) continue;
    ++contents;
    towardsWall += out;
  }
  const auto all = static_cast<double>((surface.size() + step - 1) / step);
  const auto isWall = [&](std::size_t count) { return static_cast<double>(count) > kWall * all; };
  const auto inWalls = static_cast<double>(std::accumulate(walls.begin(), walls.end(), std::size_t{0}));
  return std::ranges::count_if(walls, isWall) >= kFewestWalls && inWalls > kWalls * all &&
         static_cast<double>(contents) > kContents * all && towardsWall > kFromWall * static_cast<double>(contents);
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
  std::array<Fronts, 3> fronts;
  std::array<std::array<double, 2>, 3> seen;
  const unsigned used = surface.size() < kLarge ? 1 : threads;
  parallelBlocks(3, 1, used, [&](std::size_t axis, std::size_t) {
    fronts[axis] = frontsAlong(static_cast<int>(axis), surface, cells);
    seen[axis] = votesAlong(static_cast<int>(axis), surface, fronts[axis]);
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
  if (std::abs(votes) > kBalanced * all) return (votes < 0) != isRoom(surface, cells, fronts, votes < 0 ? -1 : 1);
  for (const FacingPoint& point : surface) sum += DVec3(point.normal);
  const auto most = static_cast<double>(surface.size());
  facing = glm::dot(sum, front);
  if (std::abs(facing) > kBalanced * most) return facing < 0;
  const DVec3 third = glm::abs(glm::cross(above, front));
  return glm::dot(sum, third) < 0;
}

}  // namespace palpate
