#include "haptics/session/vulkan_backend.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/session/backend_kind.hpp"

namespace palpate {

const bool kOnGpu = true;

std::unique_ptr<BackendKind> backendKind() {
  return vulkanBackend([]() -> Device& { return coreValidatedDevice(); }, [](Device&) { return std::string(); });
}

}  // namespace palpate
