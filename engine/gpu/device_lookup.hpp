// Finds the GPU that a device would use, without creating the device.
#pragma once

#include "engine/gpu/device.hpp"

namespace palpate {

/// The GPU of a Device with these options; creates nothing. Throws the errors of the Device: GpuError if there is no
/// GPU, or it lacks a feature.
GpuDescription gpuFor(const DeviceOptions& options);
/// Whether that is a GPU, not a software driver. False if there is no usable GPU; throws GpuError if one is requested
/// by name.
bool hasRealGpu(const DeviceOptions& options);
/// All GPUs of this machine, in the order of their numbers; empty without Vulkan.
std::vector<GpuDescription> gpusHere();

}  // namespace palpate
