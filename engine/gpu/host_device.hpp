// A device made by another program, and the queues that it lends.
#pragma once

#include <functional>
#include <span>

#include "engine/gpu/device_choice.hpp"
#include "engine/gpu/instance.hpp"

namespace palpate {

/// A queue that the host lends. It must support compute.
struct HostQueue {
  VkQueue handle = VK_NULL_HANDLE;
  std::uint32_t family = 0;
};

/// The host's objects and their creation parameters, which Vulkan cannot query afterwards. All of it must outlive the
/// Device that adopts it, and is not modified; the chain of features is read only during adoption. A program has one
/// loader: `getInstanceProcAddr` must be the same for every Device in it.
struct HostDevice {
  PFN_vkGetInstanceProcAddr getInstanceProcAddr = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  std::uint32_t apiVersion = 0;  ///< with which the instance was made (VkApplicationInfo::apiVersion); 1.3 or later
  Validation validation = Validation::off;  ///< the instance's validation
  bool debugUtils = false;                  ///< the instance has VK_EXT_debug_utils: objects and passes get names
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  /// As in VkDeviceCreateInfo, with its chain. Features are read from VkPhysicalDeviceVulkan12Features,
  /// VkPhysicalDeviceVulkan13Features, and the structs of the extensions that were promoted to those.
  const VkPhysicalDeviceFeatures2* features = nullptr;
  HostQueue throughput;  ///< with graphics, if anything is to be drawn
  HostQueue latency;     ///< null: shares throughput
  HostQueue background;  ///< null: shares throughput
  /// Called around every submission to a queue, by the submitting thread, for the duration of vkQueueSubmit2: the host
  /// holds the same lock when it uses the queue itself. May be empty if it never does. The GPU is never waited for
  /// while it is held.
  std::function<void(VkQueue)> lock, unlock;
};

/// The features that palpate uses, either supported by a device or enabled on one.
struct Features {
  bool bufferDeviceAddress = false, scalarBlockLayout = false, synchronization2 = false, computeFullSubgroups = false;
  bool subgroupSizeControl = false;
  bool bufferInt64Atomics = false, int64 = false, clocks = false, dynamicRendering = false, largePoints = false;
};
/// The features in a chain.
Features featuresIn(const VkPhysicalDeviceFeatures2& features);

/// The roles of the lent queues, numbered within their families in order.
QueueRoles rolesOf(const HostDevice& host, std::span<const VkQueueFamilyProperties> families);

/// Throw GpuError that names everything missing for adoption: first the handles needed to query the driver, then the
/// results of these queries.
void requireHandles(const HostDevice& host);
void requireAdoptable(const HostDevice& host, std::span<const FeatureState> ofPhysical,
                      std::span<const VkQueueFamilyProperties> families, const std::string& deviceName);

}  // namespace palpate
