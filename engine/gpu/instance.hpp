#pragma once

#include <mutex>
#include <span>
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

struct HostDevice;

/// The Vulkan loader and its physical devices. `windowExtensions`: those required by a window system. Throws GpuError
/// without a loader, or if a requested layer or extension is missing.
class Instance {
 public:
  explicit Instance(Validation validation, std::span<const std::string> windowExtensions = {});
  /// Uses an instance of another program, which keeps ownership.
  explicit Instance(const HostDevice& host);
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  VkInstance handle() const { return instance_; }
  bool validates() const { return validation_ != Validation::off; }
  Validation validation() const { return validation_; }
  bool hasDebugUtils() const { return hasDebugUtils_; }
  ValidationMessages& messages() { return messages_; }
  std::vector<VkPhysicalDevice> physicalDevices() const;

 private:
  bool owns_ = true;
  Validation validation_ = Validation::off;
  bool hasDebugUtils_ = false;
  ValidationMessages messages_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

}  // namespace palpate
