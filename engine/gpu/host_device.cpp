#include "engine/gpu/host_device.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace palpate {

Features featuresIn(const VkPhysicalDeviceFeatures2& features) {
  Features found{.int64 = features.features.shaderInt64 == VK_TRUE,
                 .largePoints = features.features.largePoints == VK_TRUE};
  const auto note = [](bool& feature, VkBool32 on) { feature = feature || on == VK_TRUE; };
  for (auto* at = static_cast<const VkBaseInStructure*>(features.pNext); at; at = at->pNext) {
    const void* const is = at;
    switch (at->sType) {
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES: {
        const auto& v12 = *static_cast<const VkPhysicalDeviceVulkan12Features*>(is);
        note(found.bufferDeviceAddress, v12.bufferDeviceAddress);
        note(found.scalarBlockLayout, v12.scalarBlockLayout);
        note(found.bufferInt64Atomics, v12.shaderBufferInt64Atomics);
        break;
      }
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES: {
        const auto& v13 = *static_cast<const VkPhysicalDeviceVulkan13Features*>(is);
        note(found.synchronization2, v13.synchronization2);
        note(found.computeFullSubgroups, v13.computeFullSubgroups);
        note(found.subgroupSizeControl, v13.subgroupSizeControl);
        note(found.dynamicRendering, v13.dynamicRendering);
        break;
      }
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_BUFFER_DEVICE_ADDRESS_FEATURES:
        note(found.bufferDeviceAddress,
             static_cast<const VkPhysicalDeviceBufferDeviceAddressFeatures*>(is)->bufferDeviceAddress);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SCALAR_BLOCK_LAYOUT_FEATURES:
        note(found.scalarBlockLayout,
             static_cast<const VkPhysicalDeviceScalarBlockLayoutFeatures*>(is)->scalarBlockLayout);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES:
        note(found.synchronization2,
             static_cast<const VkPhysicalDeviceSynchronization2Features*>(is)->synchronization2);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_FEATURES:
        note(found.computeFullSubgroups,
             static_cast<const VkPhysicalDeviceSubgroupSizeControlFeatures*>(is)->computeFullSubgroups);
        note(found.subgroupSizeControl,
             static_cast<const VkPhysicalDeviceSubgroupSizeControlFeatures*>(is)->subgroupSizeControl);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_ATOMIC_INT64_FEATURES:
        note(found.bufferInt64Atomics,
             static_cast<const VkPhysicalDeviceShaderAtomicInt64Features*>(is)->shaderBufferInt64Atomics);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES:
        note(found.dynamicRendering,
             static_cast<const VkPhysicalDeviceDynamicRenderingFeatures*>(is)->dynamicRendering);
        break;
      case VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_CLOCK_FEATURES_KHR:
        note(found.clocks, static_cast<const VkPhysicalDeviceShaderClockFeaturesKHR*>(is)->shaderDeviceClock &&
                               static_cast<const VkPhysicalDeviceShaderClockFeaturesKHR*>(is)->shaderSubgroupClock);
        break;
      default:
        break;
    }
  }
  return found;
}

QueueRoles rolesOf(const HostDevice& host, std::span<const VkQueueFamilyProperties> families) {
  std::vector<std::pair<VkQueue, QueueChoice>> known;
  std::map<std::uint32_t, std::uint32_t> ofFamily;
  const auto choice = [&](const HostQueue& queue) {
    const HostQueue& used = queue.handle ? queue : host.throughput;
    const auto found = std::ranges::find(known, used.handle, [](const auto& each) { return each.first; });
    if (found != known.end()) return found->second;
    return known.emplace_back(used.handle, QueueChoice{used.family, ofFamily[used.family]++}).second;
  };
  const QueueChoice throughput = choice(host.throughput), latency = choice(host.latency);
  return {.latency = latency,
          .throughput = throughput,
          .background = choice(host.background),
          .draws = (families[throughput.family].queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0};
}

void requireHandles(const HostDevice& host) {
  std::vector<std::string_view> missing;
  if (!host.getInstanceProcAddr) missing.emplace_back("vkGetInstanceProcAddr");
  if (!host.instance) missing.emplace_back("an instance");
  if (host.apiVersion < VK_API_VERSION_1_3) missing.emplace_back("an instance made for Vulkan 1.3");
  if (!host.physical) missing.emplace_back("a physical device");
  if (!host.device) missing.emplace_back("a device");
  if (!host.lock != !host.unlock) missing.emplace_back("lock and unlock, or neither");
  if (!missing.empty()) throw GpuError("the host program did not provide {}", fmt::join(missing, ", "));
}

void requireAdoptable(const HostDevice& host, std::span<const FeatureState> ofPhysical,
                      std::span<const VkQueueFamilyProperties> families, const std::string& deviceName) {
  std::vector<std::string> missing;
  for (const FeatureState& feature : ofPhysical)
    if (!feature.present) missing.push_back(fmt::format("{} (not supported by the GPU)", feature.name));
  if (!host.features) missing.emplace_back("the list of its enabled features");
  const Features enabled = host.features ? featuresIn(*host.features) : Features{};
  for (const auto& [name, on] : {std::pair("bufferDeviceAddress", enabled.bufferDeviceAddress),
                                 {"scalarBlockLayout", enabled.scalarBlockLayout},
                                 {"synchronization2", enabled.synchronization2},
                                 {"computeFullSubgroups", enabled.computeFullSubgroups}})
    if (host.features && !on) missing.push_back(fmt::format("{} (not enabled)", name));
  if (!host.throughput.handle) missing.emplace_back("a queue for throughput");
  for (const HostQueue& queue : {host.throughput, host.latency, host.background}) {
    if (!queue.handle) continue;
    if (queue.family >= families.size() || !(families[queue.family].queueFlags & VK_QUEUE_COMPUTE_BIT))
      missing.push_back(fmt::format("a compute queue of family {}", queue.family));
  }
  if (!missing.empty())
    throw GpuError("the host program's device on {} lacks {}", deviceName, fmt::join(missing, ", "));
}

}  // namespace palpate
