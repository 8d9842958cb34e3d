// A GPU that reports the minimum of Vulkan 1.3, whatever the driver behind it supports.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace madeup {

/// Limits and features by Vulkan's names. All have Vulkan's minimum: no optional features, one graphics queue without
/// timestamps, no extension except VK_KHR_portability_subset, which a program must then enable. `text` gives exceptions
/// ("maxPushConstantsSize=256,shaderInt64=1"), which may be below the minimum too; deviceType is a
/// VkPhysicalDeviceType; that, vendorID, and the bounds of required subgroup sizes are the driver's own if they are 0.
/// An unknown name ends the program.
class Gpu {
 public:
  explicit Gpu(const std::string& text);

  /// Reduces the driver's answers to those of this GPU: never more than the driver's.
  void amend(VkPhysicalDeviceProperties& properties) const;
  void amend(VkPhysicalDeviceProperties2& properties) const;
  void amend(VkPhysicalDeviceFeatures& features) const;
  void amend(VkPhysicalDeviceFeatures2& features) const;
  void amend(VkQueueFamilyProperties& family) const;
  /// The extensions to request from the driver; false if a correct program would not create this device.
  bool accepts(const VkDeviceCreateInfo& info, std::vector<const char*>& extensions) const;

  static constexpr const char* kExtension = "VK_KHR_portability_subset";

 private:
  void amend(VkPhysicalDeviceLimits& limits) const;
  void withoutArithmetic(VkSubgroupFeatureFlags& operations) const;
  std::uint64_t least(std::uint64_t drivers, const char* name) const;
  void without(VkBool32& feature, const char* name) const;

  std::map<std::string, std::uint64_t> values_;
};

}  // namespace madeup
