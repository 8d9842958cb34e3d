// What to install where a part of Vulkan is missing.
#pragma once

namespace palpate {

/// Error text: the loader, the system's library through which programs reach drivers, was not found.
extern const char* const kNoVulkanLoader;
/// What provides the validation layer.
extern const char* const kValidationLayerSource;

}  // namespace palpate
