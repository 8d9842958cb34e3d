#pragma once

#include <memory>
#include <string>
#include <vector>

#include "haptics/session/backends.hpp"

namespace palpate {

/// A GPU through CUDA, for comparison. Its name and capabilities are known in a palpate built without CUDA, too, where
/// everything that needs the GPU throws Error.
std::unique_ptr<BackendKind> cudaBackend();

/// Names of its methods. The same in every build.
const std::vector<std::string>& cudaMethods();

}  // namespace palpate
