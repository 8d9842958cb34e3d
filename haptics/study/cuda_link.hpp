// Interface of the CUDA back end to engine/cuda, if palpate is built with it.
#pragma once

#include <memory>
#include <string>

#include "haptics/session/backends.hpp"

namespace palpate {

/// Makes a cloud that answers with one of cudaMethods(). Throws CudaError if CUDA can use no GPU, and Error in a
/// palpate built without CUDA.
std::unique_ptr<TouchBackend> makeCudaTouch(const BackendRequest& request, const std::string& method);

/// Name of the GPU that CUDA uses.
std::string cudaMachine();

}  // namespace palpate
