// A GPU that says of itself the least that Vulkan 1.3 lets one say, whatever the driver behind it can do.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace madeup {

/// Limits and features by Vulkan's names. All are Vulkan's minimum: none of the features that it leaves to the driver,
/// one queue that draws but tells no times, no extension but VK_KHR_portability_subset, which a program has to enable
/// then; but for those that `text` names ("maxPushConstantsSize=256,shaderInt64=1"). What is smaller than the minimum
/// may be asked for, too. A name that is not known ends the program.
class Gpu {
 public:
  explicit Gpu(const std::string& text);

  /// What the driver has said, as this GPU says it: never more than the driver.
  void amend(VkPhysicalDeviceLimits& limits) const;
  void amend(VkPhysicalDeviceProperties2& properties) const;
  void amend(VkPhysicalDeviceFeatures& features) const;
  void amend(VkPhysicalDeviceFeatures2& features) const;
  void amend(VkQueueFamilyProperties& family) const;
  /// The extensions to ask the driver for; false: a program that was right would not have made this device.
  bool accepts(const VkDeviceCreateInfo& info, std::vector<const char*>& extensions) const;

  static constexpr const char* kExtension = "VK_KHR_portability_subset";

 private:
  std::uint64_t least(std::uint64_t drivers, const char* name) const;
  void without(VkBool32& feature, const char* name) const;

  std::map<std::string, std::uint64_t> values_;
};

}  // namespace madeup
