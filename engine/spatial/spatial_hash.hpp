#pragma once

#include "engine/spatial/hash_grid.hpp"
#include "engine/spatial/live_cloud.hpp"
#include "engine/spatial/radix_sort.hpp"
#include "shaders/shared/spatial_hash.h"

namespace palpate {

/// The index of a live cloud: a hashed regular grid, built by key, sort, ranges and reorder (thesis section 4.2; grid
/// and hash after Teschner et al. 2003). Memory grows with the number of points, never with the extent of the cloud.
class SpatialHash {
 public:
  SpatialHash(Device& device, const HashGrid& grid, std::uint32_t capacity);

  /// Records a full build: reads the points on `from`, writes them in bucket order to `to`. The caller flips the cloud.
  void recordBuild(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                   std::uint32_t count) const;

  const HashGrid& grid() const { return grid_; }
  const Buffer& ranges() const { return ranges_; }
  /// What a query needs to read the points on `side`.
  shared::CloudView view(const LiveCloud::Side& side, std::uint32_t count) const;
  /// Bytes on the GPU besides the cloud itself.
  std::uint64_t bytes() const;
  /// The same for a cloud that is not there yet; the sort's scratch, a few per cent, differs a little between GPUs.
  static std::uint64_t predictedBytes(std::uint64_t points);

 private:
  HashGrid grid_;
  RadixSort sort_;
  ComputePipeline keysPass_, reorderPass_;
  Buffer keys_, order_, keysAlt_, orderAlt_, scratch_, ranges_;
};

}  // namespace palpate
