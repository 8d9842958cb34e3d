#pragma once

#include <string>

#include "engine/core/error.hpp"

namespace palpate {

/// The CUDA runtime or its GPU could not do what was requested.
class CudaError : public Error {
 public:
  using Error::Error;
};

/// Whether this machine has a GPU that CUDA can use.
bool cudaDevicePresent();

/// The name of the GPU that CUDA uses, with ", CUDA" appended. Throws CudaError if there is none.
std::string cudaDeviceName();

}  // namespace palpate
