// Vulkan for this room: volk's function pointers, and errors that name the call and the device.
#pragma once

#include <volk.h>

#include <string_view>

#include "engine/core/error.hpp"

namespace palpate {

using DeviceAddress = VkDeviceAddress;

/// The device is lost and cannot be used any more.
class DeviceLost : public GpuError {
 public:
  using GpuError::GpuError;
};
class OutOfGpuMemory : public GpuError {
 public:
  using GpuError::GpuError;
};

std::string_view resultName(VkResult result);

/// Throws DeviceLost, OutOfGpuMemory or GpuError if `result` is an error. `call` is the Vulkan function.
void checkVk(VkResult result, std::string_view call, std::string_view deviceName);

}  // namespace palpate
