// The CUDA back end as the programs see it, whether this palpate was built with it or not.
#pragma once

#include "apps/backend.hpp"

namespace palpate {

/// Names of the methods of the CUDA back end on the command line. The same in every build.
const std::vector<std::string>& cudaMethods();

/// Throws CudaError where there is no GPU that CUDA can use, and Error in a palpate that was built without CUDA.
std::unique_ptr<TouchBackend> makeCudaBackend(const Model& model, const TouchOptions& options,
                                              const std::string& method);

}  // namespace palpate
