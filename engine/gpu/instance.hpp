#pragma once

#include <memory>
#include <vector>

#include "engine/gpu/validation.hpp"

namespace palpate {

/// The Vulkan loader and its physical devices. With `validate`, the Khronos layer watches with core, synchronisation
/// and GPU-assisted validation. Throws GpuError when there is no loader, or no layer where one was asked for.
class Instance {
 public:
  explicit Instance(bool validate);
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
