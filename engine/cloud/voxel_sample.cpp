#include "engine/cloud/voxel_sample.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <span>

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

std::vector<std::uint32_t> sampled(const PointCloud& cloud) {
  const std::size_t count = std::min(cloud.size(), kMaxSamples);
  std::vector<std::uint32_t> sample(count);
  for (std::size_t i = 0; i < count; ++i)
    sample[i] = static_cast<std::uint32_t>((2 * i + 1) * cloud.size() / (2 * count));
  return sample;
}

/// The region of nearly all points, with a wide margin.
Bounds windowOf(const PointCloud& cloud, const std::vector<std::uint32_t>& sample) {
  Bounds window;
  std::vector<float> along(sample.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < sample.size(); ++i) along[i] = cloud.positions[sample[i]][axis];
    const auto tail = static_cast<std::ptrdiff_t>(kSampleTail * static_cast<double>(sample.size()));
    std::nth_element(along.begin(), along.begin() + tail, along.end());
    const double low = along[static_cast<std::size_t>(tail)];
    std::nth_element(along.begin(), along.end() - 1 - tail, along.end());
    const double high = along[along.size() - 1 - static_cast<std::size_t>(tail)];
    window.min[axis] = low;
    window.max[axis] = high;
  }
  // By the longest side: parts of a flat shape may project from its plane.
  const double around = kBeyond * window.longestSide();
  window.min -= around;
  window.max += around;
  return window;
}

/// Points sorted by the numbers of their cells.
class Cells {
 public:
  Cells(const PointCloud& cloud, const std::vector<std::uint32_t>& sample, const Bounds& window, double side)
      : window_(window), side_(side) {
    for (const std::uint32_t i : sample) {
      const DVec3 p(cloud.positions[i]);
      if (window.contains(p)) entries_.push_back({keyOf(p), i});
    }
    std::ranges::sort(entries_);
    for (std::size_t i = 0; i < entries_.size(); ++i)
      if (i == 0 || entries_[i].key != entries_[i - 1].key) begins_.push_back(i);
  }

  std::size_t count() const { return begins_.size(); }
  struct Entry {
    std::uint64_t key;
    std::uint32_t point;
    auto operator<=>(const Entry&) const = default;
  };
  std::span<const Entry> of(std::size_t cell) const {
    const std::size_t end = cell + 1 < begins_.size() ? begins_[cell + 1] : entries_.size();
    return std::span(entries_).subspan(begins_[cell], end - begins_[cell]);
  }
  /// Number of points in the cell and in the cells around it.
  std::size_t companyOf(std::size_t cell) const {
    const std::uint64_t key = entries_[begins_[cell]].key;
    std::size_t company = 0;
    for (std::uint64_t dz = 0; dz < 3; ++dz)
      for (std::uint64_t dy = 0; dy < 3; ++dy)  // three cells in a row of x have consecutive keys
        company += inRow(key + ((dz << 42) + (dy << 21)) - ((1ull << 42) + (1ull << 21)));
    return company;
  }

 private:
  std::uint64_t keyOf(const DVec3& p) const {
    const DVec3 cell = glm::floor((p - window_.min) / side_) + 1.0;  // so that the first cell has a predecessor
    return static_cast<std::uint64_t>(cell.z) << 42 | static_cast<std::uint64_t>(cell.y) << 21 |
           static_cast<std::uint64_t>(cell.x);
  }
  std::size_t inRow(std::uint64_t middle) const {
    const auto keyed = [](const Entry& entry) { return entry.key; };
    const auto first = std::ranges::lower_bound(entries_, middle - 1, {}, keyed);
    auto last = first;
    while (last != entries_.end() && last->key <= middle + 1) ++last;
    return static_cast<std::size_t>(last - first);
  }

  Bounds window_;
  double side_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> begins_;
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
    for (const Cells::Entry& entry : cells.of(i)) kept.push_back(entry.point);
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
  return inCompany(Cells(cloud, sample, window, side), kCompany);
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

}  // namespace

VoxelSample voxelSampleOf(const PointCloud& cloud) {
  VoxelSample voxels;
  if (cloud.empty()) return voxels;
  const std::vector<std::uint32_t> sample = sampled(cloud);
  const std::vector<std::uint32_t> kept = withoutOutliers(cloud, sample, windowOf(cloud, sample));
  const Bounds box = boxOf(cloud, kept);
  voxels.cell = box.longestSide() / kFineCells;
  if (!(voxels.cell > 0)) return voxels;
  const Cells cells(cloud, kept, box, voxels.cell);
  PointCloud places;
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < cells.count(); ++i) {
    DVec3 place(0), normal(0);
    for (const Cells::Entry& entry : cells.of(i)) {
      place += DVec3(cloud.positions[entry.point]);
      if (cloud.hasNormals()) normal += DVec3(cloud.normals[entry.point]);
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
  const std::vector<std::uint32_t> sample = sampled(cloud);
  if (sample.size() < kEnoughToTell) return all;
  const std::vector<std::uint32_t> kept = withoutOutliers(cloud, sample, windowOf(cloud, sample));
  const double outliers = 1 - static_cast<double>(kept.size()) / static_cast<double>(sample.size());
  const Bounds core = boxOf(cloud, kept);
  const bool widen = all.longestSide() > kMuchLarger * core.longestSide();
  if (!widen || outliers > kMaxOutliers || !(core.longestSide() > 0)) return all;
  // The sample may miss the outermost points.
  const double slack = core.longestSide() / kMaxCells;
  return {glm::max(all.min, core.min - slack), glm::min(all.max, core.max + slack)};
}

}  // namespace palpate
