// Which GPU a device would be made for, before one is.
#pragma once

#include "engine/gpu/device.hpp"

namespace palpate {

/// The GPU that a Device with these options is made for; nothing is made. Throws what the Device would: GpuError where
/// there is none, or it lacks something.
GpuDescription gpuFor(const DeviceOptions& options);
/// Whether that is a GPU, and not a software driver. False where there is none that palpate could use; throws GpuError
/// where one is asked for by name.
bool hasRealGpu(const DeviceOptions& options);
/// All of this machine, in the order of their numbers; none where there is no Vulkan.
std::vector<GpuDescription> gpusHere();

}  // namespace palpate
