// CUB's times on the GPU, us, for comparison with palpate's own. Each throws Error in a palpate built without CUDA.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/spatial/hash_grid.hpp"

namespace palpate {

/// A build of the index.
std::vector<double> cubBuildTimes_us(const PointCloud& cloud, const HashGrid& grid, int repeat);
/// A sort of (key, number) pairs.
std::vector<double> cubSortTimes_us(std::span<const std::uint32_t> keys, unsigned bits, int repeat);

}  // namespace palpate
