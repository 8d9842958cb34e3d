#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/gpu/validation.hpp"

namespace palpate {

struct HostDevice;

/// The Vulkan loader and its physical devices. `windowExtensions`: those that a window system needs. Throws GpuError
/// when there is no loader, and no layer or extension where one was asked for.
class Instance {
 public:
  explicit Instance(Validation validation, std::span<const std::string> windowExtensions = {});
  /// One that another program has made, and keeps.
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
