#include "haptics/devices/path_device.hpp"

#include <limits>

namespace palpate {

DeviceLimits PathDevice::limits() const {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  return {.peakForce_N = kNone, .continuousForce_N = kNone, .fastest_mm_per_s = kNone, .handHeld = false};
}

DeviceState PathDevice::read(double time_s) noexcept { return {.position = path_.at(time_s), .ok = true}; }

bool PathDevice::write(const DVec3& force_N) noexcept {
  lastForce_N_ = force_N;
  return true;
}

}  // namespace palpate
