#include "engine/contact/neighbour_distances.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "engine/cloud/spacing.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/neighbour_distances.h"

namespace palpate {

namespace {

constexpr std::size_t kBucketsPerPoint = 4;  // buckets for each point: visiting points of other cells costs time, too
constexpr double kSurfaceShare = 0.5;        // squared edge of a cell, in squared spacings, for each neighbour
// Exponents of the grids' edges: crowded points go on in the finer ones, sparse points in the coarser ones.
constexpr std::array kFiner{-1, -2, -3}, kCoarser{1, 2, 3};
constexpr double kBetweenGrids = 4;
constexpr double kSmallest = 1e-12, kLargest = 1e12;  // spacings whose squares floats hold, with what they lack
// Distances that scans compute at most, and in one submission, which a driver must not think hangs.
constexpr double kMaxScanned = 5e11, kScannedAtOnce = 2e9;

/// The passes over one cloud.
class DistancePasses {
 public:
  DistancePasses(Device& device, const PointCloud& cloud, std::uint32_t neighbours, unsigned threads)
      : device_(device),
        neighbours_(neighbours),
        threads_(threads),
        origin_(boundsOf(cloud).min),
        live_(device, cloud.positions),
        distances_(Buffer::of<Vec2>(device, cloud.size(), Memory::device, "neighbour distances")),
        near_(device, shader_code::contact_neighbour_distances, {.pushBytes = sizeof(shared::NeighbourDistancesArgs)}),
        scan_(device, shader_code::contact_scan_distances,
              {.workgroupSize = shared::kScanWorkgroup, .pushBytes = sizeof(shared::ScanDistancesArgs)}),
        values_(parallelMake(cloud.size(), threads, [](std::size_t) { return Vec2(shared::kExamined, 0); })) {}

  const BareVector<Vec2>& values() const { return values_; }

  /// Examines the points of that value in a grid whose cells have that edge. Returns how many there were.
  std::size_t examine(float which, double edge) {
    const std::size_t found = count(which);
    if (found == 0) return 0;
    rename(which, shared::kExamined);
    build(edge);
    run([&](CommandList& list) {
      list.dispatch(near_, live_.slots(),
                    shared::NeighbourDistancesArgs{.cloud = hash_->view(live_.front(), live_.count()),
                                                   .distances = distances_.address(),
                                                   .radius = static_cast<float>(edge),
                                                   .neighbours = neighbours_});
    });
    return found;
  }
  std::size_t count(float which) const {
    return parallelCount(values_.size(), threads_, [&](std::size_t i) { return values_[i].x == which; });
  }
  /// Gives the points of a value another one.
  void rename(float from, float to) {
    parallelFor(values_.size(), threads_, [&](std::size_t begin, std::size_t end) {
      for (Vec2& value : std::span(values_).subspan(begin, end - begin))
        if (value.x == from) value = Vec2(to, 0);
    });
  }
  /// Scans all points for those that are left; false if that takes too long.
  bool scan() {
    if (count(shared::kLeft) == 0) return true;
    std::vector<std::uint32_t> slots;
    const auto positions = download<Vec4>(device_, live_.front().positions, live_.slots());
    for (std::uint32_t slot = 0; slot < positions.size(); ++slot)
      if (values_[std::bit_cast<std::uint32_t>(positions[slot].w)].x == shared::kLeft) slots.push_back(slot);
    const auto points = static_cast<double>(live_.slots());
    if (static_cast<double>(slots.size()) * points > kMaxScanned) return false;
    const auto atOnce = static_cast<std::size_t>(std::max(1.0, kScannedAtOnce / points));
    const Buffer left = Buffer::of<std::uint32_t>(device_, std::max<std::size_t>(1, std::min(atOnce, slots.size())),
                                                  Memory::device, "points to scan for");
    for (std::size_t done = 0; done < slots.size(); done += atOnce) {
      const std::vector<std::uint32_t> piece(
          slots.begin() + static_cast<std::ptrdiff_t>(done),
          slots.begin() + static_cast<std::ptrdiff_t>(std::min(slots.size(), done + atOnce)));
      upload(device_, left, piece);
      run([&](CommandList& list) {
        list.dispatch(scan_, piece.size() * shared::kScanWorkgroup,
                      shared::ScanDistancesArgs{.cloud = hash_->view(live_.front(), live_.count()),
                                                .distances = distances_.address(),
                                                .left = left.address(),
                                                .neighbours = neighbours_,
                                                .unused = 0});
      });
    }
    return true;
  }

 private:
  void build(double edge) {
    hash_.reset();
    hash_.emplace(device_, makeHashGrid(Vec3(origin_), edge, kBucketsPerPoint * live_.count()), live_.count());
    hash_->build(live_);
  }
  void run(const auto& record) {
    uploadBytes(device_, device_.latencyQueue(), distances_, std::as_bytes(std::span(values_)));
    CommandList list(device_, device_.latencyQueue(), "neighbour distances");
    list.begin();
    record(list);
    list.end();
    device_.latencyQueue().run(list);
    downloadBytes(device_, device_.latencyQueue(), distances_, std::as_writable_bytes(std::span(values_)));
  }

  Device& device_;
  std::uint32_t neighbours_;
  unsigned threads_;
  DVec3 origin_;
  LiveCloud live_;
  Buffer distances_;
  ComputePipeline near_, scan_;
  std::optional<SpatialHash> hash_;
  BareVector<Vec2> values_;  // by number: sums of distances in two parts, or why there is none
};

// In double precision, by a scan of all points.
double scannedDistance(const std::vector<Vec3>& positions, std::size_t point, std::size_t neighbours) {
  std::vector<double> nearest;  // squared, ascending
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const DVec3 offset = DVec3(positions[i]) - DVec3(positions[point]);
    const double squared = glm::dot(offset, offset);
    if (i == point || (nearest.size() == neighbours && squared >= nearest.back())) continue;
    nearest.insert(std::ranges::upper_bound(nearest, squared), squared);
    if (nearest.size() > neighbours) nearest.pop_back();
  }
  double sum = 0;
  for (const double squared : nearest) sum += std::sqrt(squared);
  return sum / static_cast<double>(neighbours);
}

// Of samples: a GPU or a driver that rounds otherwise would give other outliers.
bool areExact(const std::vector<Vec3>& positions, std::span<const double> means, std::size_t neighbours,
              unsigned threads) {
  constexpr std::size_t kSamples = 16;
  constexpr double kDoubles = 1e-11;
  std::atomic<bool> areAll = true;
  parallelBlocks(std::min(kSamples, means.size()), 1, threads, [&](std::size_t k, std::size_t) {
    const std::size_t point = k * means.size() / std::min(kSamples, means.size());
    const double exact = scannedDistance(positions, point, neighbours);
    if (!(std::abs(means[point] - exact) <= kDoubles * exact)) areAll = false;
  });
  return areAll;
}

}  // namespace

std::optional<BareVector<double>> neighbourDistances(Device& device, const PointCloud& cloud, std::uint32_t neighbours,
                                                     unsigned threads) {
  if (neighbours == 0 || neighbours > shared::kMaxNearest || cloud.size() <= neighbours) return std::nullopt;
  const double spacing = roughSpacing(cloud, threads);
  if (!(spacing > kSmallest && spacing < kLargest)) return std::nullopt;
  DistancePasses passes(device, cloud, neighbours, threads);
  const double edge = spacing * std::sqrt(std::max(1.0, kSurfaceShare * neighbours));
  passes.examine(shared::kExamined, edge);
  passes.rename(shared::kCrowded, shared::kWaiting);
  // What becomes crowded in a coarser grid, or sparse in a finer one, is left to the scan.
  const auto goOn = [&](float which, float other, const auto& exponents) {
    for (const int exponent : exponents) {
      if (passes.examine(which, edge * std::pow(kBetweenGrids, exponent)) == 0) break;
      passes.rename(other, shared::kLeft);
    }
    passes.rename(which, shared::kLeft);
  };
  goOn(shared::kSparse, shared::kCrowded, kCoarser);
  passes.rename(shared::kWaiting, shared::kCrowded);
  goOn(shared::kCrowded, shared::kSparse, kFiner);
  if (!passes.scan()) return std::nullopt;
  BareVector<double> means = parallelMake(cloud.size(), threads, [&](std::size_t i) {
    return (double{passes.values()[i].x} + double{passes.values()[i].y}) / neighbours;
  });
  if (!areExact(cloud.positions, means, neighbours, threads)) return std::nullopt;
  return means;
}

}  // namespace palpate
