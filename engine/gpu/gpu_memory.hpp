#pragma once

#include <string>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

class Device;

/// Memory for a buffer or image of that name, which the caller frees and reports to Device::noteRelease(). `next`
/// extends the request. Throws OutOfGpuMemory, and GpuError if the GPU has no memory for that use.
VkDeviceMemory allocate(Device& device, const VkMemoryRequirements& needs, Memory memory, const std::string& name,
                        const void* next = nullptr);

}  // namespace palpate
