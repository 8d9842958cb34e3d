#include "engine/gpu/missing_software.hpp"

namespace palpate {

const char* const kNoVulkanLoader =
    "no Vulkan loader (vulkan-1.dll) was found; install the current driver of the graphics card, from its maker";
const char* const kValidationLayerSource = "the Vulkan SDK of LunarG";

}  // namespace palpate
