// What the Vulkan sort and the Vulkan build are measured against, on the same data in the same run.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "shaders/shared/hash_grid.h"

namespace palpate {

/// GPU times, us, one per repetition.
using CubSortTimes = std::vector<double>;

/// CUB's radix sort of (key, number) pairs by the low `bits` bits of the keys, each time from the same unsorted input,
/// which is brought back outside the measured time. Throws CudaError.
CubSortTimes timeCubSort(std::span<const std::uint32_t> keys, unsigned bits, int repeat);

struct CubBuildTimes {
  double first_us = 0;            ///< points in the cloud's own order
  std::vector<double> steady_us;  ///< points in the order of the build before
};

/// The whole index build of the CUDA back end, launched as a graph. `movedShare`: share of the points that go to
/// another cell between two builds, outside the measured time. `cloud` must have normals. Throws CudaError.
CubBuildTimes timeCubBuild(const PointCloud& cloud, const shared::HashGrid& grid, int repeat, double movedShare = 0);

}  // namespace palpate
