#include "apps/bench/cub_times.hpp"

#include "engine/cuda/cuda_measure.hpp"

namespace palpate {

std::vector<double> cubBuildTimes_us(const PointCloud& cloud, const HashGrid& grid, int repeat) {
  return timeCubBuild(cloud, grid, repeat);
}

std::vector<double> cubSortTimes_us(std::span<const std::uint32_t> keys, unsigned bits, int repeat) {
  return timeCubSort(keys, bits, repeat);
}

}  // namespace palpate
