#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/gpu/validation.hpp"

namespace palpate {

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
