#include "apps/cuda_backend.hpp"

#include <algorithm>

#include "engine/cuda/cuda_error.hpp"
#include "engine/cuda/cuda_measure.hpp"
#include "engine/cuda/cuda_touch.hpp"

namespace palpate {

std::unique_ptr<TouchBackend> makeCudaBackend(const Model& model, const TouchOptions& options,
                                              const std::string& method) {
  const double cell = std::max(options.cell > 0 ? options.cell : options.radius, smallestCell(options.radius));
  const auto& names = cudaMethods();
  const auto place = std::ranges::find(names, method) - names.begin();
  return std::make_unique<CudaTouch>(
      model.cloud, CudaTouchOptions{.radius = options.radius,
                                    .grid = makeHashGrid(Vec3(boundsOf(model.cloud).min), cell, model.cloud.size(),
                                                         options.bucketKey),
                                    .method = static_cast<CudaMethod>(place),
                                    .push = options.brush});
}

const std::vector<std::string>& cudaMethods() {
  static const std::vector<std::string> names(cudaMethodNames().begin(), cudaMethodNames().end());
  return names;
}

std::string cudaMachine() { return cudaDeviceName(); }

std::vector<double> cubBuildTimes_us(const PointCloud& cloud, const HashGrid& grid, int repeat) {
  return timeCubBuild(cloud, grid, repeat);
}

std::vector<double> cubSortTimes_us(std::span<const std::uint32_t> keys, unsigned bits, int repeat) {
  return timeCubSort(keys, bits, repeat);
}

}  // namespace palpate
