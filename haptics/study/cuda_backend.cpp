// CUDA among the back ends of a session, with its capabilities, whether this palpate was built with it or not.
#include "haptics/study/cuda_backend.hpp"

#include <algorithm>

#include "haptics/study/cuda_link.hpp"

namespace palpate {

namespace {

class CudaBackend final : public BackendKind {
 public:
  std::string_view name() const override { return "cuda"; }
  const std::vector<std::string>& methods() const override {
    // The default is first.
    static const std::vector<std::string> methods = [] {
      std::vector<std::string> names(cudaMethods().rbegin(), cudaMethods().rend());
      std::stable_partition(names.begin(), names.end(), [](const std::string& name) { return name == "fused"; });
      return names;
    }();
    return methods;
  }
  TouchCapabilities capabilities() const override {
    return {.allSurfaces = false,
            .localRadius = false,
            .manyPoints = false,
            .manyHands = false,
            .allBrushes = false,
            .followsMotion = false,
            .keepsEdits = false};
  }
  std::string machine(unsigned) const override { return cudaMachine(); }
  std::unique_ptr<TouchBackend> make(const BackendRequest& request) const override {
    return makeCudaTouch(request, methodOf(request.config.backend));
  }
};

}  // namespace

std::unique_ptr<BackendKind> cudaBackend() { return std::make_unique<CudaBackend>(); }

}  // namespace palpate
