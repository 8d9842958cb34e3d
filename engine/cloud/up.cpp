#include "engine/cloud/up.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include "engine/cloud/normals.hpp"
#include "engine/cloud/voxel_sample.hpp"

namespace palpate {

namespace {

constexpr std::size_t kFewest = 100;  // positions: fewer do not define a shape
constexpr double kFlat = 0.005;       // of the longest side: the orientation of a flatter sheet is unknown
constexpr double kThin = 0.35;        // of the next longer side: a thinner shape may be ground
constexpr double kMaxLayers = 1.4;    // of a sheet, along its thin side
constexpr double kOneSided = 0.2;     // mean of the normals, along the thin side
constexpr double kTail = 0.005;       // share of the positions cut off at each end of an axis
constexpr double kBase = 0.02;        // of the height: the lowest layer, on which a shape stands
constexpr double kContact = 0.015;    // minimum share of the positions in such a base
constexpr double kSteady = 0.15;  // tangent of the tilt at which it would fall; larger values do not improve the score
constexpr double kOpenBelow = 1.5;  // weight of the mean normal: open shapes are open below
constexpr double kOneView = 0.55;   // mean of the normals towards the viewer, for a shape seen from one side only
constexpr double kFacing = 0.85;    // cosine of 32 degrees: a normal within it faces a direction
constexpr double kMin = 0.12;       // minimum score of a standing shape
constexpr double kClearly = 1.15;   // factor by which another axis must beat y
constexpr double kAlike = 0.03;  // share of the positions by which a symmetric shape may differ from itself upside down
constexpr double kLikelyY = 1.0, kLikelyZ = 0.97, kUnlikely = 0.9;  // prior weights by how files mostly are

struct Sides {
  int axis;           // the axis of the height
  int across, along;  // the other axes
  double sign;
};
Sides sidesOf(UpAxis up) {
  const int axis = static_cast<int>(up) % 3;
  return {axis, (axis + 1) % 3, (axis + 2) % 3, static_cast<int>(up) < 3 ? 1.0 : -1.0};
}

double likely(UpAxis up) { return up == UpAxis::y ? kLikelyY : up == UpAxis::z ? kLikelyZ : kUnlikely; }

double quantile(std::vector<double> values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

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

/// Sorted heights of the positions in the cells of a plane.
using Columns = std::map<std::pair<int, int>, std::vector<double>>;

/// Number of layers in a mean column, separated by gaps of two column widths.
double layersOf(const Columns& columns, double width) {
  constexpr double kGap = 2;
  std::size_t layers = 0;
  for (const auto& [cell, heights] : columns) {
    ++layers;
    for (std::size_t i = 1; i < heights.size(); ++i) layers += heights[i] - heights[i - 1] > kGap * width;
  }
  return static_cast<double>(layers) / static_cast<double>(columns.size());
}

/// Stability of the shape in an orientation.
struct Stand {
  double score = 0;
  double base = 0;    // area of the base, relative to the outline
  double share = 0;   // share of the positions in the base
  double filled = 0;  // occupied area of the base, relative to the outline
};

class Shape {
 public:
  explicit Shape(const VoxelSample& sample) : sample_(sample) {
    for (const Vec3& place : sample.places) middle_ += DVec3(place) / static_cast<double>(sample.places.size());
    for (const Vec3& normal : sample.normals) mean_ += DVec3(normal) / static_cast<double>(sample.normals.size());
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double>& heights = heights_[static_cast<std::size_t>(axis)];
      for (const Vec3& place : sample.places) heights.push_back(place[axis]);
      low_[axis] = quantile(heights, kTail);
      high_[axis] = quantile(heights, 1 - kTail);
    }
  }

  DVec3 extent() const { return high_ - low_; }
  const DVec3& middle() const { return middle_; }
  double meanNormal(UpAxis up) const { return glm::dot(mean_, directionOf(up)); }

  Stand standing(UpAxis up) const {
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
    if (std::abs(towards) < kOneView) stand.score = stand.base * steady * contact * (1 + kOpenBelow * towards);
    return stand;
  }

  /// Whether the distribution of heights is the same upside down.
  bool isSymmetric(int axis) const {
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

  /// Number of layers along an axis that are separated by gaps.
  double layers(int axis) const { return layersOf(columns(axis), widthOfColumn(axis)); }

  /// Median over columns along an axis of the extent of their positions, relative to the whole height. 1 if no column
  /// has two positions.
  double reach(int axis) const {
    std::vector<double> reaches;
    for (const auto& [cell, heights] : columns(axis))
      if (heights.size() > 1) reaches.push_back((heights.back() - heights.front()) / extent()[axis]);
    return reaches.empty() ? 1 : quantile(reaches, 0.5);
  }

  /// Median height of the positions, 0 at the lowest and 1 at the highest.
  double medianHeight(int axis) const {
    return (quantile(heights_[static_cast<std::size_t>(axis)], 0.5) - low_[axis]) / extent()[axis];
  }

  /// Share of all positions that face a direction.
  double facing(UpAxis up) const {
    std::size_t count = 0;
    for (const Vec3& normal : sample_.normals) count += glm::dot(DVec3(normal), directionOf(up)) > kFacing;
    return static_cast<double>(count) / static_cast<double>(sample_.places.size());
  }

  /// Share of all positions at the low end of a direction that face along it, as the walls of a room do.
  double facingIn(UpAxis up) const {
    std::size_t count = 0;
    for (const std::uint32_t i : lowestPlaces(up))
      count += glm::dot(DVec3(sample_.normals[i]), directionOf(up)) > kFacing;
    return static_cast<double>(count) / static_cast<double>(sample_.places.size());
  }

  /// Share of all positions that face up between the floor and head height in a room: the furniture.
  double furniture(UpAxis up) const {
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

  /// Median height of the positions that face upwards, as in medianHeight(); 1 without any.
  double heightOfFacing(UpAxis up) const {
    const Sides sides = sidesOf(up);
    std::vector<double> heights;
    for (std::size_t i = 0; i < sample_.normals.size(); ++i) {
      if (!(glm::dot(DVec3(sample_.normals[i]), directionOf(up)) > kFacing)) continue;
      const double along = (sample_.places[i][sides.axis] - low_[sides.axis]) / extent()[sides.axis];
      heights.push_back(sides.sign > 0 ? along : 1 - along);
    }
    return heights.empty() ? 1 : quantile(heights, 0.5);
  }

  /// If a plane across an axis cuts the shape, the share of positions in the rim of the cut: a rim surrounds the low
  /// end of a direction and faces sideways, where a base faces down. 0 without one.
  double cutBelow(UpAxis up) const {
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

  /// Of the positions that do not face the thin side, whether most face along one of the other two axes: window reveals
  /// do, slopes of ground face anywhere.
  bool isFacade(int thin) const {
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

 private:
  static DVec2 flat(const DVec3& p, const Sides& sides) { return {p[sides.across], p[sides.along]}; }
  double lowEnd(const Sides& sides) const { return sides.sign > 0 ? low_[sides.axis] : -high_[sides.axis]; }

  /// The positions on which the shape would stand.
  std::vector<std::uint32_t> lowestPlaces(UpAxis up) const {
    const Sides sides = sidesOf(up);
    const double top = lowEnd(sides) + std::max(kBase * extent()[sides.axis], sample_.cell);
    std::vector<std::uint32_t> lowest;
    for (std::uint32_t i = 0; i < sample_.places.size(); ++i)
      if (sides.sign * double{sample_.places[i][sides.axis]} < top) lowest.push_back(i);
    return lowest;
  }

  /// Wide enough for some positions in each column.
  double widthOfColumn(int axis) const {
    constexpr double kPlaces = 4;
    const double area = extent()[(axis + 1) % 3] * extent()[(axis + 2) % 3];
    return std::max(sample_.cell, std::sqrt(kPlaces * area / static_cast<double>(sample_.places.size())));
  }

  Columns columns(int axis) const {
    const double width = widthOfColumn(axis);
    Columns columns;
    for (const Vec3& place : sample_.places) {
      const auto cell = [&](int k) { return static_cast<int>(std::floor(double{place[k]} / width)); };
      columns[{cell((axis + 1) % 3), cell((axis + 2) % 3)}].push_back(place[axis]);
    }
    for (auto& [cell, heights] : columns) std::ranges::sort(heights);
    return columns;
  }

  const VoxelSample& sample_;
  std::array<std::vector<double>, 3> heights_;
  DVec3 low_{0}, high_{0}, middle_{0}, mean_{0};
};

UpAxis opposite(UpAxis up) { return static_cast<UpAxis>((static_cast<int>(up) + 3) % 6); }

std::optional<Upright> asSheet(const Shape& shape) {
  const DVec3 extent = shape.extent();
  int thin = 0;
  for (int k = 1; k < 3; ++k)
    if (extent[k] < extent[thin]) thin = k;
  const double next = std::min(extent[(thin + 1) % 3], extent[(thin + 2) % 3]);
  if (extent[thin] > kThin * next) return std::nullopt;
  if (extent[thin] < kFlat * next) return Upright{UpAxis::y, "a flat sheet, which is ambiguous"};
  if (shape.layers(thin) > kMaxLayers) return std::nullopt;
  if (shape.isFacade(thin)) return Upright{thin == 1 ? UpAxis::z : UpAxis::y, "a wall with straight openings"};
  const auto positive = static_cast<UpAxis>(thin);
  const bool fromBelow = shape.meanNormal(positive) < -kOneSided;
  return Upright{fromBelow ? opposite(positive) : positive,
                 fmt::format("ground, {:.0f} % as high as wide{}", 100 * extent[thin] / next,
                             std::abs(shape.meanNormal(positive)) > kOneSided ? ", seen from above" : "")};
}

/// A room seen from inside, from one position or from one side: nothing faces away from the viewer, and the floor, seen
/// from above, is wider than any other surface across the view, and lies lowest.
std::optional<Upright> asRoom(const Shape& shape) {
  constexpr double kView = 0.5;      // minimum mean of the normals towards the viewer
  constexpr double kHidden = 0.02;   // maximum share of the positions that face away from the viewer
  constexpr double kFloor = 0.08;    // minimum share that faces up
  constexpr double kWider = 2;       // factor to the next direction across the view
  constexpr double kLowest = 0.25;   // maximum height of a floor
  constexpr double kSideways = 0.5;  // weight of x as the up axis
  UpAxis view = UpAxis::y;
  for (const auto& [name, from] : kUpAxes)
    if (shape.meanNormal(from) > shape.meanNormal(view)) view = from;
  if (shape.meanNormal(view) < kView || shape.facing(opposite(view)) > kHidden) return std::nullopt;
  std::optional<UpAxis> floor;
  double most = 0, next = 0;
  for (const auto& [name, up] : kUpAxes) {
    if (sidesOf(up).axis == sidesOf(view).axis) continue;
    const double share = shape.facing(up) * (sidesOf(up).axis == 0 ? kSideways : 1);
    next = std::max(next, std::min(most, share));
    if (share > most) {
      floor = up;
      most = share;
    }
  }
  if (floor && most > kFloor && most > kWider * next && shape.heightOfFacing(*floor) < kLowest)
    return Upright{*floor, fmt::format("a floor, {:.0f} % of what was seen from one side", 100 * shape.facing(*floor))};
  return std::nullopt;
}

/// A room seen from inside, all round: its walls face in, and more of the objects between them is seen from above than
/// from any other side.
std::optional<Upright> asInterior(const Shape& shape) {
  constexpr double kWall = 0.02;       // minimum share of the positions in a wall
  constexpr std::size_t kWalls = 4;    // minimum number
  constexpr double kFurniture = 0.02;  // minimum share of the positions
  constexpr double kMore = 1.5;        // factor to the next direction
  std::size_t walls = 0;
  UpAxis up = UpAxis::y;
  double most = 0, next = 0;
  for (const auto& [name, direction] : kUpAxes) {
    walls += shape.facingIn(direction) > kWall;
    const double share = shape.furniture(direction);
    next = std::max(next, std::min(most, share));
    if (share > most) {
      most = share;
      up = direction;
    }
  }
  if (walls < kWalls || most < kFurniture || most < kMore * next) return std::nullopt;
  return Upright{up, "a room from within, and what stands in it"};
}

/// A body that was cut off, as a head in a scanner is at its neck: it is open there, and ends in a rim. If cut off at
/// one side alone it stands on that, unless the other side is a base. If cut out of a volume at several sides, z is
/// along it, starting from the larger cut.
std::optional<Upright> asCutBody(const Shape& shape) {
  constexpr double kMore = 1.5;
  constexpr double kBaseFilled = 0.3;  // relative to the outline: a base rather than a round end
  std::array<double, 6> cuts;
  std::size_t count = 0;
  UpAxis only = UpAxis::y;
  for (const auto& [name, up] : kUpAxes) {
    cuts[static_cast<std::size_t>(up)] = shape.cutBelow(up);
    if (cuts[static_cast<std::size_t>(up)] == 0) continue;
    ++count;
    only = up;
  }
  if (count == 1 && shape.standing(opposite(only)).filled < kBaseFilled) return Upright{only, "a body cut off below"};
  const double low = cuts[static_cast<std::size_t>(UpAxis::z)], high = cuts[static_cast<std::size_t>(UpAxis::minusZ)];
  if (count < 2 || (low == 0 && high == 0)) return std::nullopt;
  return Upright{high > kMore * low ? UpAxis::minusZ : UpAxis::z, fmt::format("a body cut off at {} sides", count)};
}

/// A camera view from the origin of the file's coordinates, along z: one position in each direction, within its field
/// of view. Cameras that look along z have y down, those that look against it have y up.
std::optional<Upright> asCameraView(const PointCloud& cloud, const VoxelSample& sample, const Shape& shape) {
  constexpr double kBehind = 0.005;                  // maximum share of the positions behind the camera
  constexpr double kNarrowest = 0.2, kWidest = 1.5;  // tangents of half the field of view
  constexpr double kSkew = 0.35;                     // between its two sides
  constexpr double kDeep = 1.3;                      // minimum ratio of farthest to nearest
  constexpr double kPlaces = 6;                      // in a cell of the picture
  if (cloud.origin != DVec3(0)) return std::nullopt;
  const double ahead = shape.middle().z > 0 ? 1 : -1;
  std::array<std::vector<double>, 2> tangents;
  std::vector<double> depths;
  for (const Vec3& place : sample.places) {
    const double depth = ahead * double{place.z};
    if (!(depth > 0)) continue;
    depths.push_back(depth);
    for (int k = 0; k < 2; ++k) tangents[static_cast<std::size_t>(k)].push_back(place[k] / depth);
  }
  const auto count = static_cast<double>(sample.places.size());
  if (static_cast<double>(depths.size()) < (1 - kBehind) * count) return std::nullopt;
  if (quantile(depths, 1 - kTail) < kDeep * quantile(depths, kTail)) return std::nullopt;
  double area = 1;
  for (const std::vector<double>& side : tangents) {
    const double low = -quantile(side, kTail), high = quantile(side, 1 - kTail);
    if (std::min(low, high) < kNarrowest || std::max(low, high) > kWidest) return std::nullopt;
    if (std::abs(high - low) > kSkew * (high + low)) return std::nullopt;
    area *= high + low;
  }
  const double width = std::sqrt(kPlaces * area / count);
  Columns columns;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const auto cell = [&](std::size_t k) { return static_cast<int>(std::floor(tangents[k][i] / width)); };
    columns[{cell(0), cell(1)}].push_back(std::log(depths[i]));
  }
  for (auto& [cell, heights] : columns) std::ranges::sort(heights);
  if (layersOf(columns, width) > kMaxLayers) return std::nullopt;
  return Upright{ahead > 0 ? UpAxis::minusY : UpAxis::y, "the view of a camera at the origin"};
}

/// A scan from the air: one height over nearly all of the ground, however high the buildings. Without normals a facade
/// looks the same; but files of airborne scans have z up, and ground lies low.
std::optional<Upright> asAirborne(const Shape& shape) {
  constexpr double kReach = 0.08;       // of the height, in a typical column
  constexpr double kClearlyLess = 0.5;  // relative to the reach of columns along the other axes
  constexpr double kLow = 0.5;          // median height
  constexpr double kLayers = 1.5;
  for (int axis = 2; axis >= 0; --axis) {
    const double reach = shape.reach(axis);
    if (reach > kReach || reach > kClearlyLess * std::min(shape.reach((axis + 1) % 3), shape.reach((axis + 2) % 3)))
      continue;
    if (shape.layers(axis) > kLayers) continue;
    const auto positive = static_cast<UpAxis>(axis);
    const double towards = shape.meanNormal(positive);
    if (std::abs(towards) > kOneSided ? shape.isFacade(axis) || std::abs(towards) < kOneView : axis != 2) continue;
    const UpAxis up = towards < -kOneSided ? opposite(positive) : positive;
    const double median = shape.medianHeight(axis);
    if ((up == positive ? median : 1 - median) < kLow)
      return Upright{up, "ground seen from the air, one height over each place"};
  }
  return std::nullopt;
}

Upright byStand(const Shape& shape) {
  std::array<Stand, 6> stands;
  UpAxis best = UpAxis::y;
  const auto scoreOf = [&](UpAxis up) { return likely(up) * stands[static_cast<std::size_t>(up)].score; };
  for (const auto& [name, up] : kUpAxes) stands[static_cast<std::size_t>(up)] = shape.standing(up);
  for (const auto& [name, up] : kUpAxes)
    if (scoreOf(up) > scoreOf(best)) best = up;
  const auto number = [](UpAxis up) { return static_cast<std::size_t>(up); };
  if (scoreOf(best) < kMin) return {UpAxis::y, "the shape is ambiguous"};
  if (shape.isSymmetric(static_cast<int>(best) % 3)) return {UpAxis::y, "the shape is the same upside down"};
  if (best != UpAxis::y && scoreOf(best) < kClearly * scoreOf(UpAxis::y))
    return {UpAxis::y, "the shape is as stable in another direction"};
  const Stand& stand = stands[number(best)];
  constexpr double kFloor = 0.3;  // share of all positions
  const DVec3 extent = shape.extent();
  const int axis = sidesOf(best).axis;
  const bool wide = extent[axis] < std::min(extent[(axis + 1) % 3], extent[(axis + 2) % 3]);
  return {best, fmt::format("it stands on a {} under {:.0f} % of its outline",
                            wide && stand.share > kFloor ? "floor" : "base", std::min(100.0, 100 * stand.base))};
}

}  // namespace

std::string_view nameOf(UpAxis up) { return kUpAxes[static_cast<std::size_t>(up)].first; }

DVec3 directionOf(UpAxis up) {
  const Sides sides = sidesOf(up);
  DVec3 direction(0);
  direction[sides.axis] = sides.sign;
  return direction;
}

DVec3 frontOf(UpAxis up) {
  switch (up) {
    case UpAxis::z:
      return {0, -1, 0};
    case UpAxis::minusZ:
      return {0, 1, 0};
    case UpAxis::minusY:
      return {0, 0, -1};
    default:
      return {0, 0, 1};
  }
}

std::optional<UpAxis> upOfCameras(const DVec3& meanUp) {
  constexpr double kUpright = 0.8;  // minimum length of the mean, and minimum cosine between it and the axis
  const double size = glm::length(meanUp);
  if (!(size > kUpright)) return std::nullopt;
  for (const auto& [name, axis] : kUpAxes)
    if (glm::dot(directionOf(axis), meanUp) > kUpright * size) return axis;
  return std::nullopt;
}

std::optional<UpAxis> upSaidIn(std::span<const std::string> comments) {
  for (const std::string& comment : comments) {
    constexpr std::string_view kSays = "comment up: ";
    if (!comment.starts_with(kSays)) continue;
    const std::string_view said = std::string_view(comment).substr(kSays.size());
    for (const auto& [name, axis] : kUpAxes)
      if (name == said) return axis;
  }
  return std::nullopt;
}

Upright findUp(const PointCloud& cloud) {
  if (const auto said = upSaidIn(cloud.storedAs.comments)) return {*said, "the file says so"};
  const VoxelSample sample = voxelSampleOf(cloud);
  if (sample.places.size() < kFewest) return {UpAxis::y, "too few points to tell"};
  const Shape shape(sample);
  if (auto sheet = asSheet(shape)) return *sheet;
  if (auto room = asRoom(shape)) return *room;
  if (auto interior = sample.normals.empty() ? std::nullopt : asInterior(shape)) return *interior;
  if (auto view = asCameraView(cloud, sample, shape)) return *view;
  if (auto airborne = asAirborne(shape)) return *airborne;
  if (auto body = asCutBody(shape)) return *body;
  return byStand(shape);
}

}  // namespace palpate
