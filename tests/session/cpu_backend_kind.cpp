#include "tests/session/backend_kind.hpp"

namespace palpate {

const bool kOnGpu = false;

std::unique_ptr<BackendKind> backendKind() { return cpuBackend(); }

}  // namespace palpate
