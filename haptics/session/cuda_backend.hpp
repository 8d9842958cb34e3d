#pragma once

#include <memory>
#include <string>
#include <vector>

#include "haptics/session/backends.hpp"

namespace palpate {

/// A GPU through CUDA, for comparison; known by its name and what it can do also where palpate was built without it,
/// and then whatever needs the GPU throws Error.
std::unique_ptr<BackendKind> cudaBackend();

/// Its methods by the names that users know. The same in every build.
const std::vector<std::string>& cudaMethods();

}  // namespace palpate
