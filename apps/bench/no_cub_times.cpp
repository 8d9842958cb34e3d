// Replaces cub_times.cpp in a build without NVIDIA's compiler.
#include "apps/bench/cub_times.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

[[noreturn]] void refuse() {
  throw Error(
      "--backend cuda: this palpate was built without CUDA; rebuild it with nvcc (cmake -DPALPATE_CUDA=ON), or use "
      "--backend vulkan");
}

}  // namespace

std::vector<double> cubBuildTimes_us(const PointCloud&, const HashGrid&, int) { refuse(); }

std::vector<double> cubSortTimes_us(std::span<const std::uint32_t>, unsigned, int) { refuse(); }

}  // namespace palpate
