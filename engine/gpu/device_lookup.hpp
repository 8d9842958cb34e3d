// Which GPU a device would be made for, before one is.
#pragma once

#include "engine/gpu/device.hpp"

namespace palpate {

/// The GPU that a Device with these options is made for; nothing is made. Throws what the Device would: GpuError where
/// there is none, or it lacks something.
GpuDescription gpuFor(const DeviceOptions& options);

}  // namespace palpate
