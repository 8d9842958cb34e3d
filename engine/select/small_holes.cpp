#include "engine/select/small_holes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "engine/cloud/gaussian_records.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"
#include "engine/select/surface_faces.hpp"
#include "engine/select/thin_plate.hpp"

namespace palpate {

namespace {

constexpr double kMinFacing = 0.15;       // cosine between normals of the rim and of its plane
constexpr std::size_t kRows = 3;          // of points around the rim, beside it
constexpr std::size_t kMaxHeights = 450;  // of a thin plate
constexpr double kSmoothing = 0.1;        // of it, squared spacings
constexpr double kSamplesApart = 0.25;    // with which the inside is measured, spacings
constexpr double kClosest = 0.5;          // of a new point to others at first, spacings
constexpr int kRelaxations = 12;

/// The surface without its coincident points.
struct Surface {
  std::vector<Vec3> positions, normals;
  std::vector<std::uint32_t> points;  // of a cloud, the first one at each position
  PointTree tree;
};

/// One hole, in the plane of its rim: coordinates in spacings about the middle.
class Hole {
 public:
  Hole(const Surface& surface, const SurfaceFaces& faces, const SurfaceFaces::Face& face)
      : surface_(surface), faces_(faces), rim_(face.rim), w_(glm::normalize(face.area)) {
    const Frame3 frame = frameAround(w_);
    u_ = frame.u, v_ = frame.v;
    for (const std::uint32_t each : rim_) middle_ += DVec3(surface.positions[each]) / static_cast<double>(rim_.size());
    area_ = glm::length(face.area);
  }

  /// The positions and normals that close it; none if points are everywhere in it. Nothing if its rim folds or
  /// overlaps.
  std::optional<std::vector<std::pair<DVec3, DVec3>>> points() {
    if (!facesPlane(rim_) || !fitPlate() || !findInside()) return std::nullopt;
    std::vector<std::pair<DVec3, DVec3>> filled;
    findOthers();
    std::vector<DVec2> placed = firstPlaces();
    for (int k = 0; k < kRelaxations && !placed.empty(); ++k) relax(placed, k == kRelaxations / 2);
    for (const DVec2& at : placed) {
      const DVec3 p = lifted(at);
      if (!isFree(p)) continue;
      const DVec2 slope = plate_->slope(at);
      filled.emplace_back(p, glm::normalize(w_ - slope.x * u_ - slope.y * v_));
    }
    return filled;
  }
  std::span<const std::uint32_t> rim() const { return rim_; }

 private:
  DVec2 flat(std::uint32_t point) const {
    const DVec3 offset = DVec3(surface_.positions[point]) - middle_;
    return DVec2(glm::dot(offset, u_), glm::dot(offset, v_)) / spacing_;
  }
  DVec3 lifted(const DVec2& at) const { return middle_ + spacing_ * (at.x * u_ + at.y * v_ + plate_->height(at) * w_); }
  bool facesPlane(std::span<const std::uint32_t> points) const {
    return std::ranges::all_of(
        points, [&](std::uint32_t each) { return glm::dot(DVec3(surface_.normals[each]), w_) > kMinFacing; });
  }

  // The rim and the rows around it, which have the spacing of the surface; that of the rim misses the hole's part.
  bool fitPlate() {
    std::vector<std::uint32_t> around(rim_.begin(), rim_.end());
    std::ranges::sort(around);
    around.erase(std::unique(around.begin(), around.end()), around.end());
    std::size_t known = around.size(), row = 0;
    std::vector<std::uint32_t> sorted = around;
    for (std::size_t k = 0; k < kRows; ++k) {
      const std::size_t end = around.size();
      for (; row < end; ++row)
        for (const std::uint32_t next : faces_.neighboursOf(around[row]))
          if (!std::ranges::binary_search(sorted, next) && facesPlane(std::span(&next, 1))) around.push_back(next);
      std::sort(around.begin() + static_cast<std::ptrdiff_t>(end), around.end());
      around.erase(std::unique(around.begin() + static_cast<std::ptrdiff_t>(end), around.end()), around.end());
      sorted = around;
      std::ranges::sort(sorted);
    }
    if (around.size() == known) known = 0;  // a lone ring
    std::vector<double> spacings;
    for (std::size_t i = known; i < around.size(); ++i) spacings.push_back(faces_.spacingOf(around[i]));
    const auto half = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
    std::ranges::nth_element(spacings, half);
    spacing_ = *half;
    const std::size_t step = (around.size() + kMaxHeights - 1) / kMaxHeights;
    std::vector<DVec2> at;
    std::vector<double> heights;
    for (std::size_t i = 0; i < around.size(); i += step) {
      at.push_back(flat(around[i]));
      heights.push_back(glm::dot(DVec3(surface_.positions[around[i]]) - middle_, w_) / spacing_);
    }
    if (at.size() < 6) return false;
    plate_.emplace(at, heights, kSmoothing);
    return true;
  }

  // Calls visit(place) for the places of a lattice inside the rim, seen along its normal. Rows are `apart` of each
  // other, shifted by `shift` of a step; every second one by half a step more where `staggered`.
  template <class Visit>
  void forEachInside(const DVec2& apart, const DVec2& shift, bool staggered, Visit&& visit) const {
    double low = std::numeric_limits<double>::max(), high = -low;
    std::vector<DVec2> corners;
    for (const std::uint32_t each : rim_) {
      corners.push_back(flat(each));
      low = std::min(low, corners.back().y), high = std::max(high, corners.back().y);
    }
    std::vector<std::pair<double, int>> crossings;
    const auto firstRow = static_cast<std::int64_t>(std::floor(low / apart.y)) - 1;
    for (std::int64_t row = firstRow; static_cast<double>(row) * apart.y <= high; ++row) {
      throwIfStopWanted();
      const double y = (static_cast<double>(row) + shift.y) * apart.y;
      crossings.clear();
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const DVec2 a = corners[i], b = corners[(i + 1) % corners.size()];
        if ((a.y <= y) == (b.y <= y)) continue;
        crossings.emplace_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x), a.y <= y ? 1 : -1);
      }
      std::ranges::sort(crossings);
      const double from = shift.x + (staggered && row % 2 != 0 ? 0.5 : 0);
      int winding = 0;
      for (std::size_t k = 0; k + 1 < crossings.size(); ++k) {
        winding += crossings[k].second;
        if (winding == 0) continue;
        for (double step = std::ceil(crossings[k].first / apart.x - from);
             (step + from) * apart.x < crossings[k + 1].first; ++step)
          visit(DVec2((step + from) * apart.x, y), winding);
      }
    }
  }

  // Samples of the inside, and their shares of the surface. False if the rim overlaps itself.
  bool findInside() {
    bool isSimple = true;
    double slopes = 0;
    forEachInside(DVec2(kSamplesApart), DVec2(0.5), false, [&](const DVec2& at, int winding) {
      isSimple &= winding == -1 || winding == 1;
      const DVec2 slope = plate_->slope(at);
      inside_.push_back({at, std::sqrt(1 + glm::dot(slope, slope))});
      slopes += inside_.back().share;
    });
    if (inside_.empty()) return false;
    stretch_ = slopes / static_cast<double>(inside_.size());
    const double measured = static_cast<double>(inside_.size()) * kSamplesApart * kSamplesApart;
    constexpr double kAlike = 0.25;  // of the area
    return isSimple && std::abs(measured * spacing_ * spacing_ / area_ - 1) < kAlike;
  }

  void findOthers() {
    double farthest = 0;
    for (const std::uint32_t each : rim_)
      farthest = std::max(farthest, glm::distance(DVec3(surface_.positions[each]), middle_));
    std::vector<std::uint32_t> near;
    surface_.tree.near(middle_, farthest + 2 * spacing_, near);
    std::ranges::sort(near);
    for (const std::uint32_t each : near) sites_.push_back(surface_.positions[each]);
    fixed_ = sites_.size();
  }
  bool isFree(const DVec3& p) const {
    std::array<std::uint32_t, 1> nearest{};
    std::array<double, 1> squared{};
    surface_.tree.nearest(Vec3(p), nearest, squared);
    return squared[0] >= kClosest * kClosest * spacing_ * spacing_;
  }

  // A hexagonal lattice with an area of a squared spacing for each point, of those shifted differently the one with
  // about the mean number of points.
  std::vector<DVec2> firstPlaces() {
    constexpr int kShifts = 4;
    const double side = std::sqrt(2 / std::sqrt(3.0) / stretch_);
    const DVec2 apart(side, side * std::sqrt(3.0) / 2);
    std::vector<std::vector<DVec2>> lattices;
    double mean = 0;
    for (int k = 0; k < kShifts * kShifts; ++k) {
      std::vector<DVec2>& lattice = lattices.emplace_back();
      const DVec2 shift(DVec2(k % kShifts, k / kShifts) / double(kShifts));
      forEachInside(apart, shift, true, [&](const DVec2& at, int) {
        if (isFree(lifted(at))) lattice.push_back(at);
      });
      mean += static_cast<double>(lattice.size()) / (kShifts * kShifts);
    }
    constexpr double kMinEmpty = 0.3;  // of the area
    if (mean < kMinEmpty * stretch_ * area_ / (spacing_ * spacing_)) return {};
    return *std::ranges::min_element(lattices, {}, [&](const std::vector<DVec2>& lattice) {
      return std::abs(static_cast<double>(lattice.size()) - mean);
    });
  }

  // Moves each to the middle of what is nearest to it. `thins`: leaves out those for which there is little between
  // others.
  void relax(std::vector<DVec2>& placed, bool thins) {
    constexpr double kLittle = 0.6 / (kSamplesApart * kSamplesApart);  // samples: of a squared spacing
    sites_.resize(fixed_);
    for (const DVec2& at : placed) sites_.emplace_back(lifted(at));
    const PointTree tree(sites_);
    std::vector<DVec3> sums(placed.size(), DVec3(0));
    std::array<std::uint32_t, 1> nearest{};
    std::array<double, 1> squared{};
    for (Sample& sample : inside_) {
      if (!sample.position) sample.position = Vec3(lifted(sample.at));
      tree.nearest(*sample.position, nearest, squared);
      if (nearest[0] >= fixed_) sums[nearest[0] - fixed_] += sample.share * DVec3(sample.at, 1);
    }
    for (std::size_t k = 0; k < placed.size(); ++k)
      if (sums[k].z > 0) placed[k] = DVec2(sums[k]) / sums[k].z;
    std::size_t number = 0;
    if (thins) std::erase_if(placed, [&](const DVec2&) { return sums[number++].z < kLittle; });
  }

  const Surface& surface_;
  const SurfaceFaces& faces_;
  std::span<const std::uint32_t> rim_;
  DVec3 middle_{0}, u_{0}, v_{0}, w_{0};
  double area_ = 0, spacing_ = 1, stretch_ = 1;
  std::optional<ThinPlate> plate_;
  struct Sample {
    DVec2 at;
    double share;
    std::optional<Vec3> position = {};
  };
  std::vector<Sample> inside_;
  std::vector<Vec3> sites_;  // others, then new points
  std::size_t fixed_ = 0;
};

// The colour and the parent of a point, by its distances from the rim.
NewPoint newPoint(const PointCloud& cloud, const Surface& surface, std::span<const std::uint32_t> rim,
                  const std::pair<DVec3, DVec3>& place) {
  NewPoint made{.position = Vec3(place.first), .normal = Vec3(place.second)};
  DVec4 color(0);
  double weights = 0, least = std::numeric_limits<double>::max();
  for (const std::uint32_t each : rim) {
    const DVec3 offset = DVec3(surface.positions[each]) - place.first;
    const double squared = glm::dot(offset, offset);
    const std::uint32_t point = surface.points[each];
    if (squared < least) least = squared, made.parent = point;
    if (!cloud.hasColors() || !(squared > 0)) continue;
    const auto& [r, g, b, a] = cloud.colors[point];
    color += DVec4(r, g, b, a) / squared;
    weights += 1 / squared;
  }
  if (weights > 0)
    for (int k = 0; k < 4; ++k)
      made.color[static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(std::lround(color[k] / weights));
  return made;
}

std::vector<Vec3> normalsOf(const PointCloud& cloud, unsigned threads) {
  if (cloud.hasNormals()) return cloud.normals;
  PointCloud bare{.positions = cloud.positions};
  estimateNormals(bare, 16, threads);
  return std::move(bare.normals);
}

}  // namespace

std::string inWords(const HoleFilling& filling, double perUnit, std::string_view unit) {
  std::string words =
      fmt::format("closes {} with {}", counted(filling.closed, "hole"), counted(filling.points.size(), "new point"));
  if (filling.left > 0)
    words += fmt::format("; {} left open, whose rim folds", counted(filling.left, "hole is", "holes are"));
  if (filling.wider > 0) {
    // Rounded up, so that this length closes it.
    const double width = filling.narrowest * perUnit;
    const double step = std::pow(10.0, std::floor(std::log10(width)) - 2);
    words += fmt::format("; {} wider{} {:.6g} {}", counted(filling.wider, "hole is", "holes are"),
                         filling.wider == 1 ? ":" : ", the narrowest", std::ceil(width / step) * step, unit);
  }
  return words;
}

HoleFilling fillHoles(const PointCloud& cloud, double widest, unsigned threads) {
  if (gaussiansOf(cloud)) throw Error("{}", kGaussiansKeepHoles);
  HoleFilling filling;
  Places places = distinctPlaces(cloud.positions);
  const std::size_t count = places.positions.size();
  if (count < 3) return filling;
  const std::vector<Vec3> normals = normalsOf(cloud, threads);
  Surface surface{.positions = std::move(places.positions),
                  .normals = std::vector<Vec3>(count),
                  .points = std::vector<std::uint32_t>(count),
                  .tree = PointTree()};
  for (std::size_t i = cloud.size(); i-- > 0;) {
    surface.points[places.placeOf[i]] = static_cast<std::uint32_t>(i);
    surface.normals[places.placeOf[i]] = normals[i];
  }
  surface.tree.build(surface.positions);
  const SurfaceFaces faces(surface.positions, surface.normals, surface.tree, threads);
  const SurfaceFaces::Holes all = faces.holes(widest);
  const std::vector<SurfaceFaces::Face>& holes = all.fitting;
  filling.wider = all.wider;
  filling.narrowest = all.narrowest;
  std::vector<std::optional<std::vector<NewPoint>>> found(holes.size());
  parallelBlocks(holes.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Hole hole(surface, faces, holes[k]);
      const auto points = hole.points();
      if (!points) continue;
      found[k].emplace();
      for (const auto& place : *points) found[k]->push_back(newPoint(cloud, surface, hole.rim(), place));
    }
  });
  for (const auto& points : found) {
    filling.left += points ? 0 : 1;
    if (!points || points->empty()) continue;
    ++filling.closed;
    filling.points.insert(filling.points.end(), points->begin(), points->end());
  }
  return filling;
}

void addPoints(PointCloud& cloud, const std::vector<NewPoint>& points) {
  const bool isExact = !cloud.exactPositions.empty(), hasNormals = cloud.hasNormals(), hasColors = cloud.hasColors();
  for (const NewPoint& point : points) {
    cloud.positions.push_back(point.position);
    if (hasNormals) cloud.normals.push_back(point.normal);
    if (hasColors) cloud.colors.push_back(point.color);
    if (isExact) cloud.exactPositions.push_back(cloud.origin + DVec3(point.position));
    for (Attribute& attribute : cloud.extra) {
      const std::size_t bytes = sizeOf(attribute.type);
      const auto from = attribute.data.begin() + static_cast<std::ptrdiff_t>(point.parent * bytes);
      const std::vector<std::byte> value(from, from + static_cast<std::ptrdiff_t>(bytes));
      attribute.data.insert(attribute.data.end(), value.begin(), value.end());
    }
  }
}

}  // namespace palpate
