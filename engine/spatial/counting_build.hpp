#pragma once

#include "engine/core/index_options.hpp"
#include "engine/spatial/hash_build.hpp"
#include "engine/spatial/prefix_scan.hpp"

namespace palpate {

class Queue;

/// Builds a SpatialHash by a counting sort: counts the points of each bucket, sums the counts, and places the points.
/// Within a bucket in the order of the ids, or of arrival.
class CountingBuild {
 public:
  /// `buckets`: including the one of the empty slots. `queue`: on which the counts are cleared immediately.
  CountingBuild(Device& device, std::uint32_t buckets, BucketOrder order, Queue& queue);

  void record(CommandList& list, const HashGrid& grid, const HashBuildScratch& scratch, const HashBuild& build) const;
  /// Whether a build has met a bucket with too many points to sort in time: the points of that bucket may be in any
  /// order.
  bool metCrowd() const { return crowded_.mapped<const std::uint32_t>()[0] != 0; }
  std::uint64_t bytes() const { return counts_.bytes() + scanScratch_.bytes() + crowded_.bytes(); }

 private:
  std::uint32_t buckets_;
  BucketOrder order_;
  RangeScan scan_;
  ComputePipeline countPass_, placePass_, settlePass_, scatterPass_;
  Buffer counts_, scanScratch_, crowded_;
};

}  // namespace palpate
