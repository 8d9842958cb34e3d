// GPUs that share the CPU's memory: buffers are written and read in place, without a second copy.
#pragma once

#include "engine/gpu/vulkan.hpp"

namespace palpate {

class Device;

/// How the host reaches the memory of the GPU's buffers.
struct UnifiedMemory {
  bool writes = false;  ///< in place
  bool reads = false;   ///< in place: the memory is cached on the host, too
};
/// For an integrated GPU, if the host can write all of its memory: the largest of its heaps. Not for other GPUs, whose
/// memory is behind a bus even where the host can write all of it.
UnifiedMemory unifiedMemory(VkPhysicalDeviceType type, const VkPhysicalDeviceMemoryProperties& memory);
UnifiedMemory unifiedMemory(const Device& device);

}  // namespace palpate
