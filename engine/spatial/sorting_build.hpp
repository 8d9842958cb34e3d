#pragma once

#include <memory>

#include "engine/core/index_options.hpp"
#include "engine/spatial/hash_build.hpp"
#include "engine/spatial/pair_sort.hpp"

namespace palpate {

/// Builds a SpatialHash by key, radix sort, ranges and reorder (thesis section 4.2). Keeps the order within a bucket.
class SortingBuild {
 public:
  /// `sort`: radix or radixLookBack, with keys of `keyBits` bits. Throws GpuError if the device does not support it.
  SortingBuild(Device& device, SortMethod sort, std::uint32_t keyBits, std::uint32_t slots);

  void record(CommandList& list, const HashGrid& grid, const HashBuildScratch& scratch, const HashBuild& build) const;
  std::uint64_t bytes() const { return sortScratch_.bytes(); }

 private:
  std::unique_ptr<PairSort> sort_;
  ComputePipeline keysPass_, reorderPass_;
  Buffer sortScratch_;
};

}  // namespace palpate
