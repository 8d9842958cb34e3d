#include "engine/matter/soft_scan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/cloud/normals.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/matter/soft_scene.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kPointsOfLeaf = 8;
// In radii of a node: distance from which its points are approximated by one dipole.
constexpr double kFar = 3;

constexpr std::size_t kMinPoints = 100;
constexpr std::size_t kNeighbours = 8;  // number of neighbours whose distance determines a point's area
constexpr double kInside = 0.5;         // winding number above which a position is inside
constexpr int kCellSamples = 4;         // samples along each axis in a cell that the surface may cross
constexpr double kWidestHole_spacings = 3;
constexpr double kWidestHole_points = 3;  // in spacings of the points
// Minimum share of a closed surface that the points cover, and the maximum number of points sampled for it.
constexpr double kMinShare = 0.44;
constexpr std::size_t kAskedPoints = 4096;
constexpr std::size_t kScanBlock = 256;  // points or cells per work item of a thread

template <class Each>
void forEachOf(std::size_t count, WorkerTeam& team, Each&& each) {
  team.forEach((count + kScanBlock - 1) / kScanBlock, [&](std::size_t block) {
    for (std::size_t i = block * kScanBlock; i < std::min((block + 1) * kScanBlock, count); ++i) each(i);
  });
}

std::vector<OrientedArea> areasOf(std::span<const SurfacePlace> points, const PointTree& tree, WorkerTeam& team) {
  std::vector<OrientedArea> areas(points.size());
  forEachOf(points.size(), team, [&](std::size_t i) {
    std::array<std::uint32_t, kNeighbours + 1> near;
    std::array<double, kNeighbours + 1> distances2;
    const std::size_t found = tree.nearest(points[i].rest, near, distances2);
    // The farthest neighbour, on the circle through it, counts as half inside.
    const double area = std::numbers::pi * distances2[found - 1] / (static_cast<double>(found) - 0.5);
    areas[i] = {.place = points[i].rest, .normal = points[i].normal, .area = static_cast<float>(area)};
  });
  return areas;
}

// Working data while a scan is filled.
struct Filling {
  std::span<const SurfacePlace> points;
  const PointTree& tree;
  const WindingNumber& winding;
  double widestHole_m;
  double share;  // shareOfClosed()
  WorkerTeam& team;
  LatticeBox box;
  std::vector<float> windings;    // at the centre of each cell
  std::vector<std::size_t> kept;  // cells with points, ascending

  DVec3 middleOf(const IVec3& cell) const { return box.corner + box.spacing_m * (DVec3(cell) + 0.5); }
  bool isInside(const IVec3& cell) const {
    return box.holds(cell) && windings[box.numberOf(cell)] > static_cast<float>(kInside);
  }
};

// The box of all points plus a layer of cells around them.
LatticeBox boxAbout(std::span<const SurfacePlace> points, double spacing_m) {
  DVec3 low(points[0].rest), high = low;
  for (const SurfacePlace& point : points) {
    low = glm::min(low, DVec3(point.rest));
    high = glm::max(high, DVec3(point.rest));
  }
  return LatticeBox::about(low - 1.01 * spacing_m, high + 1.01 * spacing_m, spacing_m);
}

void wind(Filling& filling) {
  filling.windings.resize(filling.box.filled.size());
  forEachOf(filling.windings.size(), filling.team, [&](std::size_t c) {
    filling.windings[c] = static_cast<float>(filling.winding.at(filling.middleOf(filling.box.cellOf(c))));
  });
  for (const SurfacePlace& point : filling.points)
    filling.kept.push_back(filling.box.numberOf(filling.box.cellAt(DVec3(point.rest))));
  std::ranges::sort(filling.kept);
  filling.kept.erase(std::unique(filling.kept.begin(), filling.kept.end()), filling.kept.end());
}

// Share of a closed surface that the points cover. Just before and behind each point the winding numbers are 0 and 1 on
// a closed surface, and -1/2 and +1/2 on a flat sheet: their mean is half of the covered share, and a quarter for an
// open hemisphere. Negative if normals point inwards.
double shareOfClosed(std::span<const OrientedArea> areas, const WindingNumber& winding, WorkerTeam& team) {
  const std::size_t stride = std::max<std::size_t>(1, areas.size() / kAskedPoints);
  std::vector<double> sums((areas.size() + stride - 1) / stride);
  forEachOf(sums.size(), team, [&](std::size_t i) {
    const OrientedArea& point = areas[i * stride];
    const DVec3 place(point.place), off = std::sqrt(static_cast<double>(point.area)) * DVec3(point.normal);
    sums[i] = winding.at(place + off) + winding.at(place - off);
  });
  double sum = 0, area = 0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const auto its = static_cast<double>(areas[i * stride].area);
    sum += its * sums[i];
    area += its;
  }
  return area > 0 ? sum / area : 0;
}

[[noreturn]] void refuseOpen(const Filling& filling) {
  throw Error(
      "model: is not closed: its points are {:.0f} % of a surface that encloses something; a body needs a surface all "
      "around, with normals that point outwards",
      100 * std::max(0.0, filling.share));
}

void requireInside(const Filling& filling) {
  const float most = std::ranges::max(filling.windings);
  if (static_cast<double>(most) > kInside) return;
  if (filling.share < -kMinShare) throw Error("model: its normals point inwards; flip them");
  if (filling.share < kMinShare) refuseOpen(filling);
  throw Error("model: encloses nothing that is {:g} mm wide; a body needs a closed surface",
              filling.box.spacing_m * 1e3);
}

// Between inside and outside cells is either the surface or the film over a hole: there points are far, and the
// farthest position is the middle of the hole.
void requireClosed(const Filling& filling) {
  const LatticeBox& box = filling.box;
  std::vector<double> widths(box.filled.size(), 0.0);
  std::vector<DVec3> places(box.filled.size());
  forEachOf(widths.size(), filling.team, [&](std::size_t c) {
    const IVec3 cell = box.cellOf(c);
    if (!filling.isInside(cell)) return;
    for (int side = 0; side < 6; ++side) {
      IVec3 beside(0);
      beside[side / 2] = side % 2 == 0 ? -1 : 1;
      if (filling.isInside(cell + beside)) continue;
      const DVec3 face = filling.middleOf(cell) + 0.5 * box.spacing_m * DVec3(beside);
      std::uint32_t nearest = 0;
      double distance2 = 0;
      filling.tree.nearest(Vec3(face), {&nearest, 1}, {&distance2, 1});
      if (const double width = 2 * std::sqrt(distance2); width > widths[c]) widths[c] = width, places[c] = face;
    }
  });
  const auto widest = static_cast<std::size_t>(std::ranges::max_element(widths) - widths.begin());
  if (widths[widest] <= filling.widestHole_m) return;
  const DVec3 place = places[widest] * 1e3;
  throw Error(
      "model: is not closed: there is a hole about {:.1f} mm wide at {:.1f}, {:.1f}, {:.1f} mm of the box; a body "
      "needs a surface all around; at this spacing and hole_mm, holes of up to {:.1f} mm are closed",
      widths[widest] * 1e3, place.x, place.y, place.z, filling.widestHole_m * 1e3);
}

// Cells that the surface may cross: those with points, and their neighbours.
std::vector<char> cutCells(const Filling& filling) {
  std::vector<char> cut(filling.box.filled.size(), 0);
  for (const std::size_t c : filling.kept)
    for (int k = 0; k < 27; ++k) {
      const IVec3 cell = filling.box.cellOf(c) + IVec3(k % 3, k / 3 % 3, k / 9) - 1;
      if (filling.box.holds(cell)) cut[filling.box.numberOf(cell)] = 1;
    }
  return cut;
}

void fill(Filling& filling) {
  LatticeBox& box = filling.box;
  const std::vector<char> cut = cutCells(filling);
  forEachOf(box.filled.size(), filling.team, [&](std::size_t c) {
    const IVec3 cell = box.cellOf(c);
    if (cut[c] == 0) {
      box.filled[c] = filling.isInside(cell) ? 1.0f : 0.0f;
      return;
    }
    int inside = 0;
    for (int k = 0; k < kCellSamples * kCellSamples * kCellSamples; ++k) {
      const DVec3 sample =
          DVec3(k % kCellSamples, k / kCellSamples % kCellSamples, k / kCellSamples / kCellSamples) + 0.5;
      inside +=
          filling.winding.at(box.corner + box.spacing_m * (DVec3(cell) + sample / double(kCellSamples))) > kInside;
    }
    box.filled[c] = static_cast<float>(inside) / (kCellSamples * kCellSamples * kCellSamples);
  });
}

// One position per cube of half a spacing: the mean of its points.
std::vector<SurfacePlace> thinned(std::span<const SurfacePlace> points, const LatticeBox& box) {
  const LatticeBox cubes{.corner = box.corner, .spacing_m = box.spacing_m / 2, .cells = 2 * box.cells};
  std::vector<std::pair<std::size_t, std::size_t>> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    order.emplace_back(cubes.numberOf(cubes.cellAt(DVec3(points[i].rest))), i);
  std::ranges::sort(order);
  std::vector<SurfacePlace> thin;
  for (std::size_t k = 0; k < order.size();) {
    DVec3 place(0), normal(0);
    const std::size_t begin = k;
    for (; k < order.size() && order[k].first == order[begin].first; ++k) {
      place += DVec3(points[order[k].second].rest);
      normal += DVec3(points[order[k].second].normal);
    }
    const double length = glm::length(normal);
    thin.push_back({.rest = place / static_cast<double>(k - begin),
                    .normal = length > 0 ? Vec3(normal / length) : points[order[begin].second].normal});
  }
  return thin;
}

}  // namespace

WindingNumber::WindingNumber(std::vector<OrientedArea> points) : points_(std::move(points)) {
  if (!points_.empty()) build(0, static_cast<std::uint32_t>(points_.size()));
}

void WindingNumber::build(std::uint32_t first, std::uint32_t count) {
  const std::size_t number = nodes_.size();
  Node& node = nodes_.emplace_back(Node{.first = first, .count = count, .isLeaf = count <= kPointsOfLeaf});
  const std::span<OrientedArea> points = std::span(points_).subspan(first, count);
  DVec3 low(points[0].place), high = low, sum(0);
  double area = 0;
  for (const OrientedArea& point : points) {
    low = glm::min(low, DVec3(point.place));
    high = glm::max(high, DVec3(point.place));
    sum += static_cast<double>(point.area) * DVec3(point.place);
    area += static_cast<double>(point.area);
    node.dipole += static_cast<double>(point.area) * DVec3(point.normal);
  }
  node.middle = area > 0 ? sum / area : (low + high) / 2.0;
  for (const OrientedArea& point : points)
    node.radius = std::max(node.radius, glm::length(DVec3(point.place) - node.middle));
  if (!node.isLeaf) {
    const DVec3 sides = high - low;
    const int axis = sides.x >= sides.y && sides.x >= sides.z ? 0 : sides.y >= sides.z ? 1 : 2;
    const std::uint32_t half = count / 2;
    std::ranges::nth_element(points, points.begin() + half, {},
                             [&](const OrientedArea& point) { return point.place[axis]; });
    build(first, half);
    build(first + half, count - half);
  }
  nodes_[number].behind = static_cast<std::uint32_t>(nodes_.size());
}

double WindingNumber::at(const DVec3& place) const {
  double sum = 0;
  for (std::uint32_t n = 0; n < nodes_.size();) {
    const Node& node = nodes_[n];
    const DVec3 offset = node.middle - place;
    const double distance2 = glm::dot(offset, offset);
    if (distance2 > kFar * kFar * node.radius * node.radius && !node.isLeaf) {
      sum += glm::dot(node.dipole, offset) / (distance2 * std::sqrt(distance2));
      n = node.behind;
      continue;
    }
    if (node.isLeaf)
      for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
        const OrientedArea& point = points_[k];
        const DVec3 away = DVec3(point.place) - place;
        const auto area = static_cast<double>(point.area);
        const double nearest2 = std::max(glm::dot(away, away), area / std::numbers::pi);  // at least the disc's radius
        if (nearest2 > 0) sum += area * glm::dot(DVec3(point.normal), away) / (nearest2 * std::sqrt(nearest2));
      }
    ++n;  // for a leaf this is `behind`, as it has no descendants
  }
  return sum / (4 * std::numbers::pi);
}

std::vector<SurfacePlace> placeScan(PointCloud cloud, const MatterScene& scene, unsigned threads) {
  if (cloud.size() < kMinPoints)
    throw Error("model: has {}; a body needs a surface of at least {}", counted(cloud.size(), "point"), kMinPoints);
  if (!cloud.hasNormals()) estimateNormals(cloud, 16, threads);
  const Bounds bounds = boundsOf(cloud);
  const auto [low, high] = standOf(scene);
  const DVec3 sides = glm::max(bounds.max - bounds.min, DVec3(1e-30));
  const DVec3 scales = (high - low) / sides;
  const double scale = std::min({scales.x, scales.y, scales.z});
  if (!(bounds.longestSide() > 0) || !std::isfinite(scale)) throw Error("model: all of its points are in one place");
  const DVec3 spare = (high - low) - scale * sides;
  const DVec3 corner = low + DVec3(spare.x / 2, 0, spare.z / 2);
  std::vector<SurfacePlace> points;
  points.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    points.push_back({.rest = corner + scale * (DVec3(cloud.positions[i]) - bounds.min), .normal = cloud.normals[i]});
  return points;
}

FilledScan fillScan(std::span<const SurfacePlace> points, double spacing_m, double widestHole_m, WorkerTeam& team) {
  std::vector<Vec3> places;
  for (const SurfacePlace& point : points) places.push_back(point.rest);
  const PointTree tree(places);
  const std::vector<OrientedArea> areas = areasOf(points, tree, team);
  const double area = std::transform_reduce(areas.begin(), areas.end(), 0.0, std::plus<>(),
                                            [](const OrientedArea& point) { return static_cast<double>(point.area); });
  const double byItself =
      kWidestHole_spacings * spacing_m + kWidestHole_points * std::sqrt(area / static_cast<double>(points.size()));
  const WindingNumber winding(areas);
  Filling filling{.points = points,
                  .tree = tree,
                  .winding = winding,
                  .widestHole_m = widestHole_m > 0 ? widestHole_m : byItself,
                  .share = shareOfClosed(areas, winding, team),
                  .team = team,
                  .box = boxAbout(points, spacing_m),
                  .windings = {},
                  .kept = {}};
  wind(filling);
  requireInside(filling);
  requireClosed(filling);
  // A sheet of few, uneven points encloses some positions, and none of its holes is far from all points.
  if (filling.share < kMinShare) refuseOpen(filling);
  fill(filling);
  return {.box = std::move(filling.box), .kept = std::move(filling.kept)};
}

SoftSolid scanSolid(std::span<const SurfacePlace> points, double spacing_m, double widestHole_m, WorkerTeam& team) {
  FilledScan filled = fillScan(points, spacing_m, widestHole_m, team);
  std::vector<SurfacePlace> surface = thinned(points, filled.box);
  return {.lattice = SoftLattice(std::move(filled.box), filled.kept), .surface = std::move(surface)};
}

}  // namespace palpate
