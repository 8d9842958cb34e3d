// A device that another program has made, and what it lends of it.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/gpu/device_choice.hpp"
#include "engine/gpu/validation.hpp"

namespace palpate {

/// A queue that the host lends. It must be able to compute.
struct HostQueue {
  VkQueue handle = VK_NULL_HANDLE;
  std::uint32_t family = 0;
};

/// What the host has made, and what it made it with, which Vulkan tells nobody afterwards. All of it must outlive the
/// Device that adopts it and is left as it is; the chain of features is read while it is adopted only. One program has
/// one loader: `getInstanceProcAddr` is the same for every Device in it.
struct HostDevice {
  PFN_vkGetInstanceProcAddr getInstanceProcAddr = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  std::uint32_t apiVersion = 0;  ///< that the instance was made for (VkApplicationInfo::apiVersion); 1.3 or later
  Validation validation = Validation::off;  ///< how a validation layer watches the instance
  bool debugUtils = false;                  ///< the instance has VK_EXT_debug_utils: objects and passes get names
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  /// As VkDeviceCreateInfo had it, with its chain. Features are looked for in VkPhysicalDeviceVulkan12Features, in
  /// VkPhysicalDeviceVulkan13Features, and in the structs of the extensions that those were made of.
  const VkPhysicalDeviceFeatures2* features = nullptr;
  HostQueue throughput;  ///< with graphics, where something is to be drawn
  HostQueue latency;     ///< none: that of throughput
  HostQueue background;  ///< none: that of throughput
  /// Called around every submission to a queue, by the thread that submits, for as long as vkQueueSubmit2 takes: the
  /// host holds the same lock where it uses the queue itself. Where it never does, there may be none. Nobody waits for
  /// the GPU while it is held.
  std::function<void(VkQueue)> lock, unlock;
};

/// The features that palpate uses, whether a device has them or one was made with them.
struct Features {
  bool bufferDeviceAddress = false, scalarBlockLayout = false, synchronization2 = false, computeFullSubgroups = false;
  bool bufferInt64Atomics = false, int64 = false, deviceClock = false, dynamicRendering = false, largePoints = false;
};
/// What a chain of features says.
Features featuresIn(const VkPhysicalDeviceFeatures2& features);

/// Which queue serves whom: those that are lent, numbered within their families as they come.
QueueRoles rolesOf(const HostDevice& host, std::span<const VkQueueFamilyProperties> families);

/// Throw GpuError that names everything that is missing for the device to be adopted: first what it takes to ask the
/// driver, then what the driver says.
void requireHandles(const HostDevice& host);
void requireAdoptable(const HostDevice& host, std::span<const FeatureState> ofPhysical,
                      std::span<const VkQueueFamilyProperties> families, const std::string& deviceName);

}  // namespace palpate
