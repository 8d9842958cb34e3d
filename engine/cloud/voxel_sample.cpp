#include "engine/cloud/voxel_sample.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <span>

#include "engine/core/bucket_sort.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxSamples = 1 << 15;
constexpr double kSampleTail = 0.02;  // share of the points that may lie anywhere at each end of an axis
constexpr double kBeyond = 1.0;    // relative to the extent between the tails: farther out nothing belongs to the shape
constexpr double kFineCells = 64;  // along the longest side, for the positions
// Cells for counting neighbours are so large that a surface has about this many points in each.
constexpr double kPointsInCell = 12, kFewestCells = 4, kMaxCells = 32;
// A cell is isolated if it and its neighbours have less than this share of the usual number of points.
constexpr double kCompany = 0.05;
constexpr double kPlacesCompany = 0.3;      // the same for the sampled positions, whose density is even
constexpr std::size_t kEnoughToTell = 256;  // points: with fewer, outliers cannot be distinguished
constexpr double kMaxOutliers = 0.02;       // share of the points: more are a part of the model
constexpr double kMuchLarger = 1.25;        // outliers that enlarge the box by less are part of the model
// Of the longest side: no wider gap is within a model. A part that is much sparser than the rest adjoins it.
constexpr double kWidestGap = 0.1;

/// Indices of at most kMaxSamples of `all` points.
std::vector<std::uint32_t> sampled(std::size_t all) {
  const std::size_t count = std::min(all, kMaxSamples);
  std::vector<std::uint32_t> sample(count);
  for (std::size_t i = 0; i < count; ++i) sample[i] = static_cast<std::uint32_t>((2 * i + 1) * all / (2 * count));
  return sample;
}

/// The region of nearly all positions of a sample, with a wide margin.
template <class PositionOf>
Bounds windowOf(std::size_t count, PositionOf&& positionOf) {
  Bounds window;
  std::vector<double> along(count);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < count; ++i) along[i] = static_cast<double>(positionOf(i)[axis]);
    const auto tail = static_cast<std::ptrdiff_t>(kSampleTail * static_cast<double>(count));
    std::nth_element(along.begin(), along.begin() + tail, along.end());
    window.min[axis] = along[static_cast<std::size_t>(tail)];
    std::nth_element(along.begin(), along.end() - 1 - tail, along.end());
    window.max[axis] = along[count - 1 - static_cast<std::size_t>(tail)];
  }
  // By the longest side: parts of a flat shape may project from its plane.
  const double around = kBeyond * window.longestSide();
  window.min -= around;
  window.max += around;
  return window;
}

Bounds windowOf(const PointCloud& cloud, const std::vector<std::uint32_t>& sample) {
  return windowOf(sample.size(), [&](std::size_t i) { return cloud.positions[sample[i]]; });
}

/// Points sorted by cells of a box, with an empty layer of cells around it: x varies fastest, then y. `sample` ascends.
class Cells {
 public:
  Cells(const PointCloud& cloud, const std::vector<std::uint32_t>& sample, const Bounds& window, double side)
      : window_(window),
        side_(side),
        cells_(IVec3(glm::floor((window.max - window.min) / side)) + 3),
        sort_(static_cast<std::uint32_t>(cells_.x) * static_cast<std::uint32_t>(cells_.y) *
              static_cast<std::uint32_t>(cells_.z)) {
    const auto numberAt = [&](std::size_t k) {
      const DVec3 p(cloud.positions[sample[k]]);
      return window.contains(p) ? numberOf(p) : kNoBucket;
    };
    WorkerTeam alone(1);
    sort_.sort(sample.size(), alone, numberAt, [&](std::size_t k, std::uint32_t& point) { point = sample[k]; });
    for (std::uint32_t cell = 0; cell + 1 < sort_.starts().size(); ++cell)
      if (sort_.starts()[cell] < sort_.starts()[cell + 1]) occupied_.push_back(cell);
  }

  std::size_t count() const { return occupied_.size(); }
  std::span<const std::uint32_t> of(std::size_t k) const {
    const std::uint32_t cell = occupied_[k];
    return sort_.items().subspan(sort_.starts()[cell], sort_.starts()[cell + 1] - sort_.starts()[cell]);
  }
  /// Number of points in the cell and in the cells around it.
  std::size_t companyOf(std::size_t k) const {
    std::size_t company = 0;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y) {  // three cells in a row
        const int row = static_cast<int>(occupied_[k]) + (z * cells_.y + y) * cells_.x;
        const auto first = static_cast<std::size_t>(row) - 1;
        company += sort_.starts()[first + 3] - sort_.starts()[first];
      }
    return company;
  }

 private:
  std::uint32_t numberOf(const DVec3& p) const {
    const IVec3 cell = IVec3(glm::floor((p - window_.min) / side_)) + 1;
    return static_cast<std::uint32_t>((cell.z * cells_.y + cell.y) * cells_.x + cell.x);
  }

  Bounds window_;
  double side_;
  IVec3 cells_;
  BucketSort<std::uint32_t> sort_;
  std::vector<std::uint32_t> occupied_;
};

/// The points of cells with at least the share `least` of the usual number of points around.
std::vector<std::uint32_t> inCompany(const Cells& cells, double least) {
  std::vector<std::size_t> company(cells.count());
  for (std::size_t i = 0; i < company.size(); ++i) company[i] = cells.companyOf(i);
  std::vector<std::size_t> sorted = company;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < cells.count(); ++i) {
    if (static_cast<double>(company[i]) < least * static_cast<double>(*middle)) continue;
    kept.insert(kept.end(), cells.of(i).begin(), cells.of(i).end());
  }
  return kept;
}

/// The sample without isolated points.
std::vector<std::uint32_t> withoutOutliers(const PointCloud& cloud, const std::vector<std::uint32_t>& sample,
                                           const Bounds& window) {
  const double count = static_cast<double>(sample.size());
  const double across = std::clamp(std::sqrt(count / kPointsInCell), kFewestCells, kMaxCells);
  // The window is longer than its contents.
  const double side = window.longestSide() / (1 + 2 * kBeyond) / across;
  if (sample.size() < kEnoughToTell || !(side > 0)) return sample;
  std::vector<std::uint32_t> kept = inCompany(Cells(cloud, sample, window, side), kCompany);
  std::ranges::sort(kept);
  return kept;
}

Bounds boxOf(const PointCloud& cloud, const std::vector<std::uint32_t>& points) {
  if (points.empty()) return {};
  Bounds box{DVec3(cloud.positions[points.front()]), DVec3(cloud.positions[points.front()])};
  for (const std::uint32_t i : points) {
    box.min = glm::min(box.min, DVec3(cloud.positions[i]));
    box.max = glm::max(box.max, DVec3(cloud.positions[i]));
  }
  return box;
}

/// The box with all points of the sample that adjoin it.
Bounds withAdjoining(const PointCloud& cloud, const std::vector<std::uint32_t>& sample, Bounds box) {
  const double gap = kWidestGap * box.longestSide();
  for (bool grows = true; grows;) {
    const Bounds around{box.min - gap, box.max + gap};
    grows = false;
    for (const std::uint32_t i : sample) {
      const DVec3 p(cloud.positions[i]);
      if (!around.contains(p) || box.contains(p)) continue;
      box = {glm::min(box.min, p), glm::max(box.max, p)};
      grows = true;
    }
  }
  return box;
}

}  // namespace

VoxelSample voxelSampleOf(const PointCloud& cloud) {
  VoxelSample voxels;
  if (cloud.empty()) return voxels;
  const std::vector<std::uint32_t> sample = sampled(cloud.size());
  const std::vector<std::uint32_t> kept = withoutOutliers(cloud, sample, windowOf(cloud, sample));
  const Bounds box = boxOf(cloud, kept);
  voxels.cell = box.longestSide() / kFineCells;
  if (!(voxels.cell > 0)) return voxels;
  const Cells cells(cloud, kept, box, voxels.cell);
  PointCloud places;
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < cells.count(); ++i) {
    DVec3 place(0), normal(0);
    for (const std::uint32_t point : cells.of(i)) {
      place += DVec3(cloud.positions[point]);
      if (cloud.hasNormals()) normal += DVec3(cloud.normals[point]);
    }
    places.positions.emplace_back(place / static_cast<double>(cells.of(i).size()));
    const double length = glm::length(normal);
    places.normals.emplace_back(length > 0 ? normal / length : DVec3(0));
    all.push_back(i);
  }
  // An outlying position next to the surface has cells of it around, but few.
  for (const std::uint32_t i : inCompany(Cells(places, all, box, voxels.cell), kPlacesCompany)) {
    voxels.places.push_back(places.positions[i]);
    if (cloud.hasNormals()) voxels.normals.push_back(places.normals[i]);
  }
  return voxels;
}

Bounds coreBoundsOf(const PointCloud& cloud) {
  const Bounds all = boundsOf(cloud);
  const std::vector<std::uint32_t> sample = sampled(cloud.size());
  if (sample.size() < kEnoughToTell) return all;
  const std::vector<std::uint32_t> kept = withoutOutliers(cloud, sample, windowOf(cloud, sample));
  const double outliers = 1 - static_cast<double>(kept.size()) / static_cast<double>(sample.size());
  const Bounds core = kept.empty() ? all : withAdjoining(cloud, sample, boxOf(cloud, kept));
  const bool widen = all.longestSide() > kMuchLarger * core.longestSide();
  if (!widen || outliers > kMaxOutliers || !(core.longestSide() > 0)) return all;
  // The sample may miss the outermost points.
  const double slack = core.longestSide() / kMaxCells;
  const Bounds around{core.min - slack, core.max + slack};
  Bounds box = core;
  for (const Vec3& position : cloud.positions) {
    const DVec3 p(position);
    if (!around.contains(p)) continue;
    box.min = glm::min(box.min, p);
    box.max = glm::max(box.max, p);
  }
  return box;
}

DVec3 originOf(std::size_t count, const Bounds& box, const std::function<DVec3(std::size_t)>& positionOf) {
  if (count < kEnoughToTell) return originFor(box);
  const std::vector<std::uint32_t> sample = sampled(count);
  const Bounds window = windowOf(sample.size(), [&](std::size_t i) { return positionOf(sample[i]); });
  if (box.longestSide() <= window.longestSide()) return originFor(box);
  // The window is wider than its contents by a margin on both sides.
  const double margin = kBeyond / (1 + 2 * kBeyond) * window.longestSide();
  return originFor({window.min + margin, window.max - margin});
}

std::size_t countOutside(const PointCloud& cloud, const Bounds& box) {
  return static_cast<std::size_t>(
      std::ranges::count_if(cloud.positions, [&](const Vec3& position) { return !box.contains(DVec3(position)); }));
}

}  // namespace palpate
