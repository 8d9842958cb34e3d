#include "engine/cloud/up.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "engine/cloud/voxel_sample.hpp"

namespace palpate {

namespace {

constexpr std::size_t kFewest = 100;  // places: fewer are no shape
constexpr double kFlat = 0.005;       // of the longest side: a sheet as flat as that may hang or lie
constexpr double kThin = 0.35;        // of the next longer side: a sheet may be ground
constexpr double kMostLayers = 1.4;   // of a sheet, along its thin side
constexpr double kOneSided = 0.2;     // mean of the normals, along the thin side
constexpr double kTail = 0.005;       // of the places, at each end of a height
constexpr double kBase = 0.02;        // of the height: what stands, stands on that
constexpr double kContact = 0.015;    // share of the places that is in such a base at least
constexpr double kSteady = 0.15;      // tangent of the tilt at which it would fall: more is no better
constexpr double kOpenBelow = 1.5;    // how much the mean of the normals counts: what is open is open below
constexpr double kOneView = 0.55;     // mean of the normals towards the only side from which a thing was seen
constexpr double kLeast = 0.12;       // score of what stands at all
constexpr double kClearly = 1.15;     // better than y, or it stays y
constexpr double kAlike = 0.03;       // share of the places in which a shape differs from itself upside down
constexpr double kLikelyY = 1.0, kLikelyZ = 0.97, kUnlikely = 0.9;  // how files mostly are

struct Sides {
  int axis;           // that of the height
  int across, along;  // the others
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

/// How far inside the hull; negative outside.
double depthIn(const std::vector<DVec2>& hull, const DVec2& p) {
  double depth = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const DVec2 from = hull[i], side = hull[(i + 1) % hull.size()] - from;
    depth = std::min(depth, cross(side, p - from) / glm::length(side));
  }
  return hull.size() < 3 ? -1 : depth;
}

/// How well the shape stands this way up.
struct Stand {
  double score = 0;
  double base = 0;   // the area on which it stands, of all that is over it
  double share = 0;  // of the places that are in it
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
  double meanNormal(UpAxis up) const { return glm::dot(mean_, directionOf(up)); }

  Stand standing(UpAxis up) const {
    const Sides sides = sidesOf(up);
    const auto flat = [&](const auto& p) { return DVec2(p[sides.across], p[sides.along]); };
    const double low = sides.sign > 0 ? low_[sides.axis] : -high_[sides.axis];
    const double top = low + std::max(kBase * extent()[sides.axis], sample_.cell);
    std::vector<DVec2> base, all;
    for (const Vec3& place : sample_.places) {
      all.push_back(flat(place));
      if (sides.sign * double{place[sides.axis]} < top) base.push_back(all.back());
    }
    const double outline = areaOf(convexHull(all)), middle = sides.sign * middle_[sides.axis] - low;
    if (base.size() < 3 || !(outline > 0) || !(middle > 0)) return {};
    const std::vector<DVec2> hull = convexHull(base);
    const double steady = std::clamp(depthIn(hull, flat(middle_)) / middle / kSteady, 0.0, 1.0);
    Stand stand{.base = areaOf(hull) / outline,
                .share = static_cast<double>(base.size()) / static_cast<double>(all.size())};
    const double contact = std::min(1.0, stand.share / kContact);
    const double towards = meanNormal(up);
    if (std::abs(towards) < kOneView) stand.score = stand.base * steady * contact * (1 + kOpenBelow * towards);
    return stand;
  }

  /// Whether it looks the same upside down, as far as heights tell.
  bool isSymmetric(int axis) const {
    std::vector<double> heights = heights_[static_cast<std::size_t>(axis)];
    std::ranges::sort(heights);
    double most = 0;  // of the differences between the distribution and its mirror image (Kolmogorov, Smirnov)
    const double both = low_[axis] + high_[axis], count = static_cast<double>(heights.size());
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const auto mirrored = std::ranges::upper_bound(heights, both - heights[i]);
      const double above = static_cast<double>(heights.end() - mirrored) / count;
      most = std::max(most, std::abs(static_cast<double>(i) / count - above));
    }
    return most < kAlike;
  }

  /// Places over one another, along an axis, with a gap between them.
  double layers(int axis) const {
    // Wide enough that some places are in each.
    constexpr double kPlaces = 4;
    const double area = extent()[(axis + 1) % 3] * extent()[(axis + 2) % 3];
    const double width = std::max(sample_.cell, std::sqrt(kPlaces * area / static_cast<double>(sample_.places.size())));
    std::map<std::pair<int, int>, std::vector<double>> columns;
    for (const Vec3& place : sample_.places) {
      const auto cell = [&](int k) { return static_cast<int>(std::floor(double{place[k]} / width)); };
      columns[{cell((axis + 1) % 3), cell((axis + 2) % 3)}].push_back(place[axis]);
    }
    std::size_t layers = 0;
    constexpr double kGap = 2;  // widths of a column
    for (auto& [cell, heights] : columns) {
      std::ranges::sort(heights);
      ++layers;
      for (std::size_t i = 1; i < heights.size(); ++i) layers += heights[i] - heights[i - 1] > kGap * width;
    }
    return static_cast<double>(layers) / static_cast<double>(columns.size());
  }

  /// Of what is not seen from the thin side, how much faces along one of the other two axes: reveals of windows do, the
  /// slopes of ground face anywhere.
  bool isFacade(int thin) const {
    constexpr double kAside = 0.85, kAligned = 0.966;  // cosines of 32 and 15 degrees
    constexpr double kMostly = 0.65, kEnough = 0.03;
    std::size_t flanks = 0, aligned = 0;
    for (const Vec3& normal : sample_.normals) {
      const DVec3 n(normal);
      if (glm::dot(n, n) < 0.5 || std::abs(n[thin]) > kAside) continue;
      ++flanks;
      const double most = std::max(std::abs(n[(thin + 1) % 3]), std::abs(n[(thin + 2) % 3]));
      aligned += most > kAligned * std::sqrt(1 - n[thin] * n[thin]);
    }
    return static_cast<double>(flanks) > kEnough * static_cast<double>(sample_.normals.size()) &&
           static_cast<double>(aligned) > kMostly * static_cast<double>(flanks);
  }

 private:
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
  if (extent[thin] < kFlat * next) return Upright{UpAxis::y, "a flat sheet, which says nothing"};
  if (shape.layers(thin) > kMostLayers) return std::nullopt;
  if (shape.isFacade(thin)) return Upright{thin == 1 ? UpAxis::z : UpAxis::y, "a wall with straight openings"};
  const auto positive = static_cast<UpAxis>(thin);
  const bool fromBelow = shape.meanNormal(positive) < -kOneSided;
  return Upright{fromBelow ? opposite(positive) : positive,
                 fmt::format("ground, {:.0f} % as high as wide{}", 100 * extent[thin] / next,
                             std::abs(shape.meanNormal(positive)) > kOneSided ? ", seen from above" : "")};
}

Upright byStand(const Shape& shape) {
  std::array<Stand, 6> stands;
  UpAxis best = UpAxis::y;
  const auto scoreOf = [&](UpAxis up) { return likely(up) * stands[static_cast<std::size_t>(up)].score; };
  for (const auto& [name, up] : kUpAxes) stands[static_cast<std::size_t>(up)] = shape.standing(up);
  for (const auto& [name, up] : kUpAxes)
    if (scoreOf(up) > scoreOf(best)) best = up;
  const auto number = [](UpAxis up) { return static_cast<std::size_t>(up); };
  if (scoreOf(best) < kLeast) return {UpAxis::y, "nothing in the shape says otherwise"};
  if (shape.isSymmetric(static_cast<int>(best) % 3)) return {UpAxis::y, "the shape is the same upside down"};
  if (best != UpAxis::y && scoreOf(best) < kClearly * scoreOf(UpAxis::y))
    return {UpAxis::y, "the shape stands as well one way as another"};
  const Stand& stand = stands[number(best)];
  constexpr double kFloor = 0.3;  // of all places
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
  constexpr double kUpright = 0.8;  // length of the mean, and cosine between it and the axis
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
  return byStand(shape);
}

}  // namespace palpate
