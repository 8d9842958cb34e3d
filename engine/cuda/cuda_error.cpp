#include "engine/cuda/cuda_error.hpp"

#include "engine/cuda/cuda_check.hpp"

namespace palpate {

namespace cu {

void checkCuda(cudaError_t status, const char* what) {
  if (status == cudaSuccess) return;
  cudaGetLastError();  // clears a non-sticky error, so that the next check does not report it again
  throw CudaError("CUDA: {}: {} ({})", what, cudaGetErrorString(status), cudaGetErrorName(status));
}

}  // namespace cu

bool cudaDevicePresent() {
  int count = 0;
  const bool found = cudaGetDeviceCount(&count) == cudaSuccess && count > 0;
  cudaGetLastError();
  return found;
}

std::string cudaDeviceName() {
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  cudaGetLastError();
  if (status != cudaSuccess || count == 0)
    throw CudaError("CUDA: no usable GPU ({}); install NVIDIA's driver, or use the back end vulkan",
                    status == cudaSuccess ? "none found" : cudaGetErrorString(status));
  cudaDeviceProp properties;
  cu::checkCuda(cudaGetDeviceProperties(&properties, 0), "reading the GPU's name");
  return fmt::format("{}, CUDA", properties.name);
}

}  // namespace palpate
