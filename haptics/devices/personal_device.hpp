#pragma once

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "haptics/devices/device_axes.hpp"
#include "haptics/devices/wrapped_device.hpp"

namespace palpate {

/// A device as the person before it uses it: with the axes that they see, and a contact never stiffer than they found
/// stable. Positions and orientations are converted, forces back.
class PersonalDevice final : public WrappedDevice {
 public:
  PersonalDevice(std::unique_ptr<HapticDevice> device, const DeviceAxes& axes,
                 double mostStiffness_N_per_mm = std::numeric_limits<double>::infinity())
      : WrappedDevice(std::move(device)), toPerson_(axes.matrix()), mostStiffness_N_per_mm_(mostStiffness_N_per_mm) {
    if (axes.mirrors()) stylus_[0][0] = -1;
  }

  DeviceLimits limits() const override {
    DeviceLimits limits = WrappedDevice::limits();
    limits.mostStiffness_N_per_mm = std::min(limits.mostStiffness_N_per_mm, mostStiffness_N_per_mm_);
    return limits;
  }
  DeviceState read(double time_s) noexcept override {
    DeviceState state = WrappedDevice::read(time_s);
    state.position = toPerson_ * state.position;
    state.turn = glm::quat_cast(toPerson_ * glm::mat3_cast(state.turn) * stylus_);
    return state;
  }
  bool write(const DVec3& force_N) noexcept override {
    return WrappedDevice::write(glm::transpose(toPerson_) * force_N);
  }

 private:
  glm::dmat3 toPerson_;
  glm::dmat3 stylus_{1};  ///< mirrors its right side where the axes mirror, so that its tip points along -z as before
  double mostStiffness_N_per_mm_;
};

}  // namespace palpate
