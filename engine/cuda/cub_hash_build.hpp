#pragma once

#include "engine/cuda/cub_sort.hpp"
#include "engine/cuda/cuda_memory.hpp"
#include "shaders/shared/spatial_hash.h"

namespace palpate::cu {

/// One order of the cloud in device memory, as engine/spatial/live_cloud.hpp lays it out for Vulkan.
struct CloudHalf {
  explicit CloudHalf(std::size_t count) : positions(count), normals(count) {}
  DeviceArray<shared::vec4> positions;  ///< xyz: model units relative to the cloud's origin; w: bits of the id
  DeviceArray<shared::vec4> normals;    ///< xyz: unit; w: 1 while the point's normal waits to be refitted, else 0
};

/// The same index as SpatialHash's, bit by bit, built with CUB: keys, radix sort over exactly the bits of a bucket
/// number, ranges and reorder. Three kernels of ours and CUB's; what the Vulkan build is measured against.
class CubBuild {
 public:
  CubBuild(const shared::HashGrid& grid, std::uint32_t capacity);

  /// Reads the points on `from`, writes them in bucket order to `to`. Submits only: may be recorded into a graph.
  void record(const Stream& stream, const CloudHalf& from, const CloudHalf& to, std::uint32_t count);

  const shared::HashGrid& grid() const { return grid_; }
  const DeviceArray<shared::uvec2>& ranges() const { return ranges_; }
  /// What a query needs to read the points on `half`.
  shared::CloudView view(const CloudHalf& half, std::uint32_t count) const;

 private:
  shared::HashGrid grid_;
  unsigned keyBits_;
  DeviceArray<std::uint32_t> keys_, order_, keysAlt_, orderAlt_;
  DeviceArray<shared::uvec2> ranges_;
  DeviceArray<std::byte> scratch_;
};

}  // namespace palpate::cu
