#include "engine/gpu/unified_memory.hpp"

#include <algorithm>

#include "engine/gpu/device.hpp"

namespace palpate {

UnifiedMemory unifiedMemory(VkPhysicalDeviceType type, const VkPhysicalDeviceMemoryProperties& memory) {
  if (type != VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU) return {};
  VkDeviceSize largest = 0;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
      largest = std::max(largest, memory.memoryHeaps[i].size);
  constexpr VkMemoryPropertyFlags kBoth =
      VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {  // the first one is the one of the buffers
    const VkMemoryType& each = memory.memoryTypes[i];
    if ((each.propertyFlags & kBoth) != kBoth) continue;
    const bool isWhole = memory.memoryHeaps[each.heapIndex].size == largest;
    return {.writes = isWhole, .reads = isWhole && (each.propertyFlags & VK_MEMORY_PROPERTY_HOST_CACHED_BIT)};
  }
  return {};
}

UnifiedMemory unifiedMemory(const Device& device) {
  return unifiedMemory(device.properties().deviceType, device.memory());
}

}  // namespace palpate
