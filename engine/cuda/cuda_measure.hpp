// Baselines for the Vulkan sort and the Vulkan build, on the same data in the same run.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "shaders/shared/hash_grid.h"

namespace palpate {

/// CUB's radix sort of (key, number) pairs by the low `bits` bits of the keys, each time from the same unsorted input,
/// restored outside the measured time. GPU times, us, one per repetition. Throws CudaError.
std::vector<double> timeCubSort(std::span<const std::uint32_t> keys, unsigned bits, int repeat);

/// The whole index build of the CUDA back end, launched as a graph, each time from the cloud in its original order. GPU
/// times, us. `cloud` must have normals. Throws CudaError.
std::vector<double> timeCubBuild(const PointCloud& cloud, const shared::HashGrid& grid, int repeat);

}  // namespace palpate
