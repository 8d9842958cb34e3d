#pragma once

#include <array>

#include "engine/core/index_options.hpp"
#include "engine/spatial/counting_build.hpp"
#include "engine/spatial/hash_grid.hpp"
#include "engine/spatial/live_cloud.hpp"
#include "engine/spatial/sorting_build.hpp"
#include "shaders/shared/spatial_hash.h"

namespace palpate {

/// Whether some slots of the cloud may be empty: this takes an additional bucket, which may cost a sort time.
enum class Slots { full, spare };

/// The sort for builds that read these points in this order each time, in place of that of the last build: `counting`,
/// or the sort with look-back for many points in random order, where that has been measured to be faster. Both give the
/// same index, bit by bit.
SortMethod sortInOrder(const Device& device, const HashGrid& grid, std::span<const Vec3> positions, Slots slots);

/// The index of a live cloud: a hashed regular grid, built by key, sort, ranges and reorder (thesis section 4.2; grid
/// and hash after Teschner et al. 2003). Memory grows with the number of points, never with the extent of the cloud.
class SpatialHash {
 public:
  /// `queue`: on which its counts are cleared immediately; the latency queue by default.
  SpatialHash(Device& device, const HashGrid& grid, std::uint32_t capacity, SortMethod sort = kDefaultSort,
              BucketOrder order = BucketOrder::stable, Slots slots = Slots::full, Queue* queue = nullptr);

  /// Builds the index of `cloud` now, flips the cloud, and returns the time on the GPU, us.
  double build(LiveCloud& cloud);

  /// Records a full build: reads the `count` slots of `from`, writes their points in bucket order to `to`, and the
  /// empty slots after them. The caller flips the cloud.
  void recordBuild(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to, std::uint32_t count,
                   SortMethod sort) const;
  /// The method for the next build: `counting` is replaced by a radix sort once a build has met a crowded bucket.
  SortMethod sort() const { return counting_.metCrowd() ? fallback_ : sort_; }
  /// The replacement for `counting`; the configured method if that is another one.
  SortMethod fallback() const { return fallback_; }

  const HashGrid& grid() const { return grid_; }
  /// First and one-past-last slot of every bucket, and of the empty slots at the end, for one half of the cloud.
  const Buffer& ranges(const LiveCloud::Half& half) const { return ranges_[half.parity]; }
  /// The view for queries of the points on `half`, which has `slots` slots.
  shared::CloudView view(const LiveCloud::Half& half, std::uint32_t slots) const;
  /// GPU memory in addition to the cloud, bytes.
  std::uint64_t bytes() const;
  /// The same for a cloud that does not exist yet; the sort's scratch, a few per cent, differs slightly between GPUs.
  static std::uint64_t predictedBytes(std::uint64_t points) { return predictedBytes(points, points); }
  /// With more slots than points.
  static std::uint64_t predictedBytes(std::uint64_t points, std::uint64_t slots);

 private:
  // Including the one of the empty slots.
  std::uint32_t buckets() const { return grid_.bucketMask + 2; }

  Device& device_;
  HashGrid grid_;
  SortMethod sort_, fallback_;
  HashBuildScratch scratch_;
  SortingBuild sorting_;
  CountingBuild counting_;
  std::array<Buffer, 2> ranges_;
};

}  // namespace palpate
