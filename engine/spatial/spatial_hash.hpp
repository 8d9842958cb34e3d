#pragma once

#include <array>
#include <optional>

#include "engine/spatial/hash_grid.hpp"
#include "engine/spatial/live_cloud.hpp"
#include "engine/spatial/look_back_sort.hpp"
#include "engine/spatial/radix_sort.hpp"
#include "shaders/shared/spatial_hash.h"

namespace palpate {

/// How a build brings the points into the order of their buckets. All give the same order, bit by bit, if it is stable.
enum class SortMethod {
  radix,          ///< sorts (bucket, number) pairs; runs everywhere
  radixLookBack,  ///< the same with half the traffic, where canLookBack(); fastest on points in random order
  counting        ///< counts the points of each bucket; fastest on points that stand almost in order, runs everywhere
};
/// The order of points within a bucket: the one in which they stood, so that the same cloud gives the same index run
/// after run; or whichever came first, which saves `counting` a pass and the others nothing.
enum class BucketOrder { stable, arrival };
/// Whether some slots of the cloud may hold no point: that takes a bucket more, which a sort may pay for.
enum class Slots { full, spare };
/// Points mostly stand in the order of the last build; no driver is known on which another is faster then.
inline constexpr SortMethod kDefaultSort = SortMethod::counting;

/// The index of a live cloud: a hashed regular grid, built by key, sort, ranges and reorder (thesis section 4.2; grid
/// and hash after Teschner et al. 2003). Memory grows with the number of points, never with the extent of the cloud.
class SpatialHash {
 public:
  /// `queue`: on which its counts are cleared now; that of touch unless given.
  SpatialHash(Device& device, const HashGrid& grid, std::uint32_t capacity, SortMethod sort = kDefaultSort,
              BucketOrder order = BucketOrder::stable, Slots slots = Slots::full, Queue* queue = nullptr);

  /// Builds the index of `cloud` now, flips the cloud, and says what it took on the GPU, us.
  double build(LiveCloud& cloud);

  /// Records a full build: reads the `count` slots of `from`, writes their points in bucket order to `to`, and the
  /// empty slots behind them. The caller flips the cloud.
  void recordBuild(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to, std::uint32_t count,
                   SortMethod sort) const;
  /// What the next build should use. Counting gives way to a radix sort once a build has met a crowded bucket.
  SortMethod sort() const;
  /// What takes the place of `counting` then; sort() itself otherwise.
  SortMethod fallback() const { return fallback_; }

  const HashGrid& grid() const { return grid_; }
  /// First and one-past-last slot of every bucket, and last of the empty slots, for one side of the cloud.
  const Buffer& ranges(const LiveCloud::Side& side) const { return ranges_[side.parity]; }
  /// What a query needs to read the points on `side`, which has so many slots.
  shared::CloudView view(const LiveCloud::Side& side, std::uint32_t slots) const;
  /// Bytes on the GPU besides the cloud itself.
  std::uint64_t bytes() const;
  /// The same for a cloud that is not there yet; the sort's scratch, a few per cent, differs a little between GPUs.
  static std::uint64_t predictedBytes(std::uint64_t points) { return predictedBytes(points, points); }
  /// With more slots than points.
  static std::uint64_t predictedBytes(std::uint64_t points, std::uint64_t slots);

 private:
  void recordSorted(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                    std::uint32_t count) const;
  void recordCounted(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                     std::uint32_t count) const;
  // With the one of the empty slots.
  std::uint32_t buckets() const { return grid_.bucketMask + 2; }

  Device& device_;
  HashGrid grid_;
  SortMethod sort_, fallback_;
  BucketOrder bucketOrder_;
  std::unique_ptr<PairSort> pairSort_;
  PrefixScan scan_;
  ComputePipeline keysPass_, reorderPass_, countPass_, placePass_, settlePass_, scatterPass_;
  Buffer keys_, order_, keysAlt_, orderAlt_, sortScratch_, counts_, scanScratch_, crowded_;
  std::array<Buffer, 2> ranges_;
};

}  // namespace palpate
