#include "haptics/study/cuda_link.hpp"

#include <algorithm>

#include "engine/cuda/cuda_error.hpp"
#include "engine/cuda/cuda_touch.hpp"
#include "haptics/session/vulkan_backend.hpp"
#include "haptics/study/cuda_backend.hpp"

namespace palpate {

std::unique_ptr<TouchBackend> makeCudaTouch(const BackendRequest& request, const std::string& method) {
  const double radius = request.surface.radius;
  const auto& names = cudaMethods();
  const auto place = std::ranges::find(names, method) - names.begin();
  return std::make_unique<CudaTouch>(request.model.cloud,
                                     CudaTouchOptions{.radius = radius,
                                                      .friction = request.config.surface.friction,
                                                      .grid = gridFor(request.model, request.config.index, radius),
                                                      .method = static_cast<CudaMethod>(place),
                                                      .push = request.brush});
}

const std::vector<std::string>& cudaMethods() {
  static const std::vector<std::string> names(cudaMethodNames().begin(), cudaMethodNames().end());
  return names;
}

std::string cudaMachine() { return cudaDeviceName(); }

}  // namespace palpate
