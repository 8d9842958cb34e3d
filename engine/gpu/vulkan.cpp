#include "engine/gpu/vulkan.hpp"

namespace palpate {

std::string_view resultName(VkResult result) {
  switch (result) {
#define PALPATE_NAME(name) \
  case name:               \
    return #name;
    PALPATE_NAME(VK_SUCCESS)
    PALPATE_NAME(VK_NOT_READY)
    PALPATE_NAME(VK_TIMEOUT)
    PALPATE_NAME(VK_INCOMPLETE)
    PALPATE_NAME(VK_ERROR_OUT_OF_HOST_MEMORY)
    PALPATE_NAME(VK_ERROR_OUT_OF_DEVICE_MEMORY)
    PALPATE_NAME(VK_ERROR_INITIALIZATION_FAILED)
    PALPATE_NAME(VK_ERROR_DEVICE_LOST)
    PALPATE_NAME(VK_ERROR_MEMORY_MAP_FAILED)
    PALPATE_NAME(VK_ERROR_LAYER_NOT_PRESENT)
    PALPATE_NAME(VK_ERROR_EXTENSION_NOT_PRESENT)
    PALPATE_NAME(VK_ERROR_FEATURE_NOT_PRESENT)
    PALPATE_NAME(VK_ERROR_INCOMPATIBLE_DRIVER)
    PALPATE_NAME(VK_ERROR_TOO_MANY_OBJECTS)
    PALPATE_NAME(VK_ERROR_NOT_PERMITTED_KHR)
#undef PALPATE_NAME
    default:
      return "an unknown VkResult";
  }
}

void checkVk(VkResult result, std::string_view call, std::string_view deviceName) {
  if (result >= 0) return;
  const std::string text =
      fmt::format("{}: {} failed with {} ({})", deviceName, call, resultName(result), static_cast<int>(result));
  switch (result) {
    case VK_ERROR_DEVICE_LOST:
      throw DeviceLost("{}: the GPU stopped; start again, and update its driver if this recurs", text);
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      throw OutOfGpuMemory("{}; free GPU memory, or ask for less", text);
    default:
      throw GpuError("{}", text);
  }
}

}  // namespace palpate
