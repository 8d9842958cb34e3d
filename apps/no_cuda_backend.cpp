// Stands in for cuda_backend.cpp where palpate is built without NVIDIA's compiler.
#include "apps/cuda_backend.hpp"

namespace palpate {

const std::vector<std::string>& cudaMethods() {
  static const std::vector<std::string> names{"brute", "two-step", "naive-dp",  "array-dp",
                                              "fused", "graph",    "persistent"};
  return names;
}

namespace {

[[noreturn]] void refuse() {
  throw Error(
      "--backend cuda: this palpate was built without CUDA; build it again where nvcc is found (cmake "
      "-DPALPATE_CUDA=ON), or take --backend vulkan");
}

}  // namespace

std::unique_ptr<TouchBackend> makeCudaBackend(const Model&, const TouchOptions&, const std::string&) { refuse(); }

std::string cudaMachine() { refuse(); }

std::vector<double> cubBuildTimes_us(const PointCloud&, const HashGrid&, int) { refuse(); }

std::vector<double> cubSortTimes_us(std::span<const std::uint32_t>, unsigned, int) { refuse(); }

}  // namespace palpate
