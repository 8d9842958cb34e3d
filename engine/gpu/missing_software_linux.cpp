#include "engine/gpu/missing_software.hpp"

namespace palpate {

const char* const kNoVulkanLoader =
    "no Vulkan loader (libvulkan.so.1) was found; install the package libvulkan1 and a driver (the software driver is "
    "mesa-vulkan-drivers)";
const char* const kValidationLayerSource = "the package vulkan-validationlayers";

}  // namespace palpate
