#pragma once

#include <string>

#include "engine/core/error.hpp"

namespace palpate {

/// The CUDA runtime or the GPU behind it could not do what was asked.
class CudaError : public Error {
 public:
  using Error::Error;
};

/// Whether this machine has a GPU that CUDA can use.
bool cudaDevicePresent();

/// The name of the GPU that CUDA uses, with ", CUDA". Throws CudaError when there is none.
std::string cudaDeviceName();

}  // namespace palpate
