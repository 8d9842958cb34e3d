#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "engine/gpu/vulkan.hpp"

namespace palpate {

/// Level of checking by the Khronos layer.
enum class Validation {
  off,
  core,  ///< every call, every shader when it is compiled, and synchronisation
  full   ///< as core, and every access of the shaders that run: GPU-assisted
};

/// Collects the messages of the validation layers. Every warning or error is printed to stderr immediately and kept, so
/// that a command can end with exit code 1 and a test can fail.
class ValidationMessages {
 public:
  std::vector<std::string> take();
  std::size_t count() const;

  /// Parameters for vkCreateDebugUtilsMessengerEXT; `this` must outlive the messenger.
  VkDebugUtilsMessengerCreateInfoEXT messengerInfo();

 private:
  static VkBool32 VKAPI_CALL receive(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                     VkDebugUtilsMessageTypeFlagsEXT types,
                                     const VkDebugUtilsMessengerCallbackDataEXT* data, void* self);

  mutable std::mutex lock_;
  std::vector<std::string> messages_;
};

}  // namespace palpate
