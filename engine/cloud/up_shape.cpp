#include "engine/cloud/up_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/cloud/normals.hpp"

namespace palpate {

namespace {

constexpr double kBase = 0.02;      // of the height: the lowest layer, on which a shape stands
constexpr double kContact = 0.015;  // minimum share of the positions in such a base
constexpr double kSteady = 0.15;  // tangent of the tilt at which it would fall; larger values do not improve the score
constexpr double kOpenBelow = 1.5;   // weight of the mean normal: open shapes are open below
constexpr double kFacing = 0.85;     // cosine of 32 degrees: a normal within it faces a direction
constexpr double kMaxColumns = 256;  // along a side of what is seen
constexpr std::uint32_t kNone = ~0u;
constexpr double kAlike = 0.03;  // share of the positions by which a symmetric shape may differ from itself upside down

double cross(const DVec2& a, const DVec2& b) { return a.x * b.y - a.y * b.x; }

/// Counterclockwise (Andrew 1979).
std::vector<DVec2> convexHull(std::vector<DVec2> points) {
  std::ranges::sort(points, [](const DVec2& a, const DVec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  std::vector<DVec2> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const DVec2& p : points) {
      while (hull.size() >= first + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0)
        hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::ranges::reverse(points);
  }
  return hull;
}

double areaOf(const std::vector<DVec2>& hull) {
  double twice = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) twice += cross(hull[i], hull[(i + 1) % hull.size()]);
  return 0.5 * twice;
}

/// Depth inside the hull; negative outside.
double depthIn(const std::vector<DVec2>& hull, const DVec2& p) {
  double depth = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const DVec2 from = hull[i], side = hull[(i + 1) % hull.size()] - from;
    depth = std::min(depth, cross(side, p - from) / glm::length(side));
  }
  return hull.size() < 3 ? -1 : depth;
}

}  // namespace

Sides sidesOf(UpAxis up) {
  const int axis = static_cast<int>(up) % 3;
  return {axis, (axis + 1) % 3, (axis + 2) % 3, static_cast<int>(up) < 3 ? 1.0 : -1.0};
}

double quantile(std::vector<double> values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

double layersOf(const Columns& columns, double width) {
  constexpr double kGap = 2;
  std::size_t layers = 0;
  for (const auto& [cell, heights] : columns) {
    ++layers;
    for (std::size_t i = 1; i < heights.size(); ++i) layers += heights[i] - heights[i - 1] > kGap * width;
  }
  return static_cast<double>(layers) / static_cast<double>(columns.size());
}

UprightShape::UprightShape(const VoxelSample& sample) : sample_(sample) {
  for (const Vec3& place : sample.places) middle_ += DVec3(place) / static_cast<double>(sample.places.size());
  for (const Vec3& normal : sample.normals) mean_ += DVec3(normal) / static_cast<double>(sample.normals.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double>& heights = heights_[static_cast<std::size_t>(axis)];
    for (const Vec3& place : sample.places) heights.push_back(place[axis]);
    low_[axis] = quantile(heights, kUpTail);
    high_[axis] = quantile(heights, 1 - kUpTail);
  }
}

Stand UprightShape::standing(UpAxis up) const {
  const Sides sides = sidesOf(up);
  const double low = lowEnd(sides);
  std::vector<DVec2> base, all;
  for (const Vec3& place : sample_.places) all.push_back(flat(place, sides));
  for (const std::uint32_t i : lowestPlaces(up)) base.push_back(all[i]);
  const double outline = areaOf(convexHull(all)), middle = sides.sign * middle_[sides.axis] - low;
  if (base.size() < 3 || !(outline > 0) || !(middle > 0)) return {};
  const std::vector<DVec2> hull = convexHull(base);
  const double steady = std::clamp(depthIn(hull, flat(middle_, sides)) / middle / kSteady, 0.0, 1.0);
  Stand stand{.base = areaOf(hull) / outline,
              .share = static_cast<double>(base.size()) / static_cast<double>(all.size()),
              .filled = static_cast<double>(base.size()) * sample_.cell * sample_.cell / outline};
  const double contact = std::min(1.0, stand.share / kContact);
  const double towards = meanNormal(up);
  if (std::abs(towards) < kUpOneView) stand.score = stand.base * steady * contact * (1 + kOpenBelow * towards);
  return stand;
}

bool UprightShape::isSymmetric(int axis) const {
  std::vector<double> heights = heights_[static_cast<std::size_t>(axis)];
  std::ranges::sort(heights);
  double most = 0;  // maximum difference between the distribution and its mirror image (Kolmogorov, Smirnov)
  const double both = low_[axis] + high_[axis], count = static_cast<double>(heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const auto mirrored = std::ranges::upper_bound(heights, both - heights[i]);
    const double above = static_cast<double>(heights.end() - mirrored) / count;
    most = std::max(most, std::abs(static_cast<double>(i) / count - above));
  }
  return most < kAlike;
}

double UprightShape::reach(int axis) const {
  std::vector<double> reaches;
  for (const auto& [cell, heights] : columns(axis))
    if (heights.size() > 1) reaches.push_back((heights.back() - heights.front()) / extent()[axis]);
  return reaches.empty() ? 1 : quantile(reaches, 0.5);
}

double UprightShape::medianHeight(int axis) const {
  return (quantile(heights_[static_cast<std::size_t>(axis)], 0.5) - low_[axis]) / extent()[axis];
}

double UprightShape::facing(UpAxis up) const {
  std::size_t count = 0;
  for (const Vec3& normal : sample_.normals) count += glm::dot(DVec3(normal), directionOf(up)) > kFacing;
  return static_cast<double>(count) / static_cast<double>(sample_.places.size());
}

double UprightShape::facingIn(UpAxis up) const {
  std::size_t count = 0;
  for (const std::uint32_t i : lowestPlaces(up))
    count += glm::dot(DVec3(sample_.normals[i]), directionOf(up)) > kFacing;
  return static_cast<double>(count) / static_cast<double>(sample_.places.size());
}

double UprightShape::furniture(UpAxis up) const {
  constexpr double kFloor = 0.08, kHead = 0.65;
  const Sides sides = sidesOf(up);
  const double low = lowEnd(sides), height = extent()[sides.axis];
  std::size_t count = 0;
  for (std::size_t i = 0; i < sample_.normals.size(); ++i) {
    const double along = (sides.sign * double{sample_.places[i][sides.axis]} - low) / height;
    count += along > kFloor && along < kHead && glm::dot(DVec3(sample_.normals[i]), directionOf(up)) > kFacing;
  }
  return static_cast<double>(count) / static_cast<double>(sample_.places.size());
}

double UprightShape::heightOfFacing(UpAxis up) const {
  const Sides sides = sidesOf(up);
  std::vector<double> heights;
  for (std::size_t i = 0; i < sample_.normals.size(); ++i) {
    if (!(glm::dot(DVec3(sample_.normals[i]), directionOf(up)) > kFacing)) continue;
    const double along = (sample_.places[i][sides.axis] - low_[sides.axis]) / extent()[sides.axis];
    heights.push_back(sides.sign > 0 ? along : 1 - along);
  }
  return heights.empty() ? 1 : quantile(heights, 0.5);
}

double UprightShape::cutBelow(UpAxis up) const {
  constexpr double kAside = 0.5;     // maximum mean magnitude of the cosine between normals and axis
  constexpr double kMinRim = 0.007;  // minimum share of the positions
  constexpr double kWide = 0.1;      // minimum area within the rim, relative to the outline
  constexpr double kAllRound = 0.8;  // minimum share of the sectors around the middle
  constexpr unsigned kNeighbours = 12;
  constexpr std::size_t kSectors = 24, kFewestPlaces = 40;
  const Sides sides = sidesOf(up);
  const std::vector<std::uint32_t> lowest = lowestPlaces(up);
  const double share = static_cast<double>(lowest.size()) / static_cast<double>(sample_.places.size());
  if (lowest.size() < kFewestPlaces || share < kMinRim) return 0;
  std::vector<DVec2> rim, all;
  for (const std::uint32_t i : lowest) rim.push_back(flat(sample_.places[i], sides));
  for (const Vec3& place : sample_.places) all.push_back(flat(place, sides));
  const std::vector<DVec2> hull = convexHull(rim);
  if (!(areaOf(hull) > kWide * areaOf(convexHull(all)))) return 0;
  DVec2 middle(0);
  for (const DVec2& p : hull) middle += p / static_cast<double>(hull.size());
  std::array<bool, kSectors> met{};
  for (const DVec2& p : rim) {
    const double turns = std::atan2(p.y - middle.y, p.x - middle.x) / (2 * std::numbers::pi) + 0.5;
    met[std::min(kSectors - 1, static_cast<std::size_t>(turns * kSectors))] = true;
  }
  if (static_cast<double>(std::ranges::count(met, true)) < kAllRound * kSectors) return 0;
  std::vector<FittedPlane> planes(sample_.places.size());
  if (sample_.normals.empty()) {
    NeighbourGraph graph{.degree = kNeighbours, .neighbours = {}};
    graph.neighbours.resize(graph.degree * sample_.places.size());
    fitNearestPlanes(sample_.places, lowest, kNeighbours, planes, graph, 1);
  }
  double aside = 0;
  for (const std::uint32_t i : lowest) {
    const Vec3& normal = sample_.normals.empty() ? planes[i].normal : sample_.normals[i];
    aside += std::abs(double{normal[sides.axis]}) / static_cast<double>(lowest.size());
  }
  return aside < kAside ? share : 0;
}

SeenSide UprightShape::seenFrom(UpAxis side) const {
  constexpr std::size_t kEnough = 5;  // of the nine columns around one
  if (sample_.normals.empty()) return {};
  const Sides sides = sidesOf(side);
  const DVec2 low = flat(low_, sides), extent = flat(high_, sides) - low;
  const double width = std::max(widthOfColumn(sides.axis), std::max(extent.x, extent.y) / kMaxColumns);
  if (!(width > 0)) return {};
  const int columns = static_cast<int>(extent.x / width) + 1, rows = static_cast<int>(extent.y / width) + 1;
  const auto numberOf = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x);
  };
  std::vector<std::uint32_t> nearest(numberOf(0, rows), kNone);
  for (std::uint32_t i = 0; i < sample_.places.size(); ++i) {
    const DVec2 at = glm::floor((flat(sample_.places[i], sides) - low) / width);
    if (at.x < 0 || at.y < 0 || at.x >= columns || at.y >= rows) continue;
    std::uint32_t& seen = nearest[numberOf(static_cast<int>(at.x), static_cast<int>(at.y))];
    const auto depth = [&](std::uint32_t k) { return sides.sign * double{sample_.places[k][sides.axis]}; };
    if (seen == kNone || depth(i) > depth(seen)) seen = i;
  }
  const auto facesViewer = [&](std::uint32_t i) { return sides.sign * double{sample_.normals[i][sides.axis]} > 0; };
  std::size_t count = 0, outside = 0, varied = 0;
  double detail = 0;
  for (int y = 1; y + 1 < rows; ++y)
    for (int x = 1; x + 1 < columns; ++x) {
      const std::uint32_t middle = nearest[numberOf(x, y)];
      if (middle == kNone) continue;
      ++count;
      if (!facesViewer(middle)) continue;
      ++outside;
      DVec3 sum(0);
      std::size_t around = 0;
      for (int k = 0; k < 9; ++k) {
        const std::uint32_t i = nearest[numberOf(x + k % 3 - 1, y + k / 3 - 1)];
        if (i == kNone || !facesViewer(i)) continue;
        sum += DVec3(sample_.normals[i]);
        ++around;
      }
      if (around < kEnough) continue;
      ++varied;
      detail += 1 - glm::length(sum) / static_cast<double>(around);
    }
  if (count == 0) return {};
  return {.outside = static_cast<double>(outside) / static_cast<double>(count),
          .detail = varied > 0 ? detail / static_cast<double>(varied) : 0};
}

bool UprightShape::isFacade(int thin) const {
  constexpr double kAside = 0.85, kAligned = 0.966;  // cosines of 32 and 15 degrees
  constexpr double kMaxly = 0.65, kEnough = 0.03;
  std::size_t flanks = 0, aligned = 0;
  for (const Vec3& normal : sample_.normals) {
    const DVec3 n(normal);
    if (glm::dot(n, n) < 0.5 || std::abs(n[thin]) > kAside) continue;
    ++flanks;
    const double most = std::max(std::abs(n[(thin + 1) % 3]), std::abs(n[(thin + 2) % 3]));
    aligned += most > kAligned * std::sqrt(1 - n[thin] * n[thin]);
  }
  return static_cast<double>(flanks) > kEnough * static_cast<double>(sample_.normals.size()) &&
         static_cast<double>(aligned) > kMaxly * static_cast<double>(flanks);
}

std::vector<std::uint32_t> UprightShape::lowestPlaces(UpAxis up) const {
  const Sides sides = sidesOf(up);
  const double top = lowEnd(sides) + std::max(kBase * extent()[sides.axis], sample_.cell);
  std::vector<std::uint32_t> lowest;
  for (std::uint32_t i = 0; i < sample_.places.size(); ++i)
    if (sides.sign * double{sample_.places[i][sides.axis]} < top) lowest.push_back(i);
  return lowest;
}

double UprightShape::widthOfColumn(int axis) const {
  constexpr double kPlaces = 4;
  const double area = extent()[(axis + 1) % 3] * extent()[(axis + 2) % 3];
  return std::max(sample_.cell, std::sqrt(kPlaces * area / static_cast<double>(sample_.places.size())));
}

Columns UprightShape::columns(int axis) const {
  const double width = widthOfColumn(axis);
  Columns columns;
  for (const Vec3& place : sample_.places) {
    const auto cell = [&](int k) { return static_cast<int>(std::floor(double{place[k]} / width)); };
    columns[{cell((axis + 1) % 3), cell((axis + 2) % 3)}].push_back(place[axis]);
  }
  for (auto& [cell, heights] : columns) std::ranges::sort(heights);
  return columns;
}

}  // namespace palpate
