#pragma once

#include "engine/cuda/cub_sort.hpp"
#include "engine/cuda/cuda_memory.hpp"
#include "shaders/shared/spatial_hash.h"

namespace palpate::cu {

/// One order of the cloud in device memory, in the layout of engine/spatial/live_cloud.hpp for Vulkan.
struct CloudHalf {
  explicit CloudHalf(std::size_t count) : positions(count), normals(count) {}
  DeviceArray<shared::vec4> positions;  ///< xyz: model units relative to the cloud's origin; w: bits of the id
  DeviceArray<shared::vec4> normals;    ///< xyz: unit; w: 1 while the normal must be refitted, else 0
};

/// An index bitwise identical to SpatialHash's, built with CUB: keys, radix sort over exactly the bits of a bucket
/// number, ranges and reorder. Three kernels of ours plus CUB's; the baseline for the Vulkan build.
class CubBuild {
 public:
  CubBuild(const shared::HashGrid& grid, std::uint32_t capacity);

  /// Reads the points of `from`, writes them in bucket order to `to`. Submits only: may be recorded into a graph.
  void record(const Stream& stream, const CloudHalf& from, const CloudHalf& to, std::uint32_t count);

  const shared::HashGrid& grid() const { return grid_; }
  const DeviceArray<shared::uvec2>& ranges() const { return ranges_; }
  /// Data that a query needs to read the points of `half`.
  shared::CloudView view(const CloudHalf& half, std::uint32_t count) const;

 private:
  shared::HashGrid grid_;
  unsigned keyBits_;
  DeviceArray<std::uint32_t> keys_, order_, keysAlt_, orderAlt_;
  DeviceArray<shared::uvec2> ranges_;
  DeviceArray<std::byte> scratch_;
};

}  // namespace palpate::cu
