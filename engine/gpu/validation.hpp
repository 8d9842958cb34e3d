#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "engine/gpu/vulkan.hpp"

namespace palpate {

/// How closely the Khronos layer watches.
enum class Validation {
  off,
  core,  ///< every call, every shader when it is compiled, and what is not synchronised
  full   ///< as core, and every access of the shaders that run: GPU-assisted
};

/// Collects what the validation layers say. Every warning or error is printed to stderr as it comes and kept, so that a
/// command can end with exit code 1 and a test can fail.
class ValidationMessages {
 public:
  std::vector<std::string> take();
  std::size_t count() const;

  /// What vkCreateDebugUtilsMessengerEXT wants; `this` must outlive the messenger.
  VkDebugUtilsMessengerCreateInfoEXT messengerInfo();

 private:
  static VkBool32 VKAPI_CALL receive(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                     VkDebugUtilsMessageTypeFlagsEXT types,
                                     const VkDebugUtilsMessengerCallbackDataEXT* data, void* self);

  mutable std::mutex lock_;
  std::vector<std::string> messages_;
};

}  // namespace palpate
