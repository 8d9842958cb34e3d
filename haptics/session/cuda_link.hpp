// What the CUDA back end takes from engine/cuda, where palpate is built with that.
#pragma once

#include <memory>
#include <string>

#include "haptics/session/backends.hpp"

namespace palpate {

/// What answers with one of cudaMethods(). Throws CudaError where there is no GPU that CUDA can use, and Error in a
/// palpate that was built without CUDA.
std::unique_ptr<TouchBackend> makeCudaTouch(const BackendRequest& request, const std::string& method);

/// The GPU that CUDA takes.
std::string cudaMachine();

}  // namespace palpate
