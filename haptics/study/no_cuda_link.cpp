// Replaces cuda_link.cpp if palpate is built without PALPATE_STUDY, or without NVIDIA's compiler.
#include "engine/core/error.hpp"
#include "haptics/study/cuda_backend.hpp"
#include "haptics/study/cuda_link.hpp"

namespace palpate {

const std::vector<std::string>& cudaMethods() {
  static const std::vector<std::string> names{"brute", "two-step", "naive-dp",  "array-dp",
                                              "fused", "graph",    "persistent"};
  return names;
}

namespace {

[[noreturn]] void refuse() {
  throw Error(
      "cuda: this palpate was built without CUDA; build it again where nvcc is found (cmake -DPALPATE_STUDY=ON "
      "-DPALPATE_CUDA=ON), or take vulkan");
}

}  // namespace

std::unique_ptr<TouchBackend> makeCudaTouch(const BackendRequest&, const std::string&) { refuse(); }

std::string cudaMachine() { refuse(); }

}  // namespace palpate
