#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/gpu/validation.hpp"

namespace palpate {

/// The Vulkan loader and its physical devices. With `validate`, the Khronos layer watches with core, synchronisation
/// and GPU-assisted validation. `windowExtensions`: those that a window system needs. Throws GpuError when there is no
/// loader, and no layer or extension where one was asked for.
class Instance {
 public:
  explicit Instance(bool validate, std::span<const std::string> windowExtensions = {});
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  VkInstance handle() const { return instance_; }
  bool validates() const { return validates_; }
  bool hasDebugUtils() const { return hasDebugUtils_; }
  ValidationMessages& messages() { return messages_; }
  std::vector<VkPhysicalDevice> physicalDevices() const;

 private:
  bool validates_ = false;
  bool hasDebugUtils_ = false;
  ValidationMessages messages_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

}  // namespace palpate
