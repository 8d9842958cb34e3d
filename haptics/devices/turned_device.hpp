#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include "engine/core/latest_value.hpp"
#include "haptics/devices/wrapped_device.hpp"

namespace palpate {

/// A device with the axes of the viewer: right, up and towards the eye, in the model's axes. So the stylus moves on the
/// screen as the hand does, for any view of the model. Forces are rotated back.
class TurnedDevice final : public WrappedDevice {
 public:
  /// Rotates about `middle_mm` of the workspace, which becomes the origin.
  TurnedDevice(std::unique_ptr<HapticDevice> device, const DVec3& middle_mm)
      : WrappedDevice(std::move(device)), middle_mm_(middle_mm) {}

  /// The columns are right, up and towards the eye: orthonormal. On one thread, which never waits for the ticks. A new
  /// view starts a new contact, since there was no motion from the old position to the new one.
  void setAxes(const glm::dmat3& axes) noexcept { viewAxes_.store(axes); }

  DeviceState read(double time_s) noexcept override {
    DeviceState state = WrappedDevice::read(time_s);
    seen_.store(state);
    if (const auto axes = viewAxes_.load(); axes && *axes != axes_) {
      axes_ = *axes;
      turn_ = glm::quat_cast(axes_);
      state.putDown = true;
    }
    state.position = axes_ * (state.position - middle_mm_);
    state.turn = turn_ * state.turn;
    return state;
  }
  bool write(const DVec3& force_N) noexcept override { return WrappedDevice::write(glm::transpose(axes_) * force_N); }

  /// As it was read last, before it was rotated; empty before the first tick, and now and then. Like setAxes().
  std::optional<DeviceState> seen() const noexcept { return seen_.load(); }

 private:
  DVec3 middle_mm_;
  LatestValue<glm::dmat3> viewAxes_;
  LatestValue<DeviceState> seen_;
  // Used by the thread that ticks.
  glm::dmat3 axes_{1};
  DQuat turn_{1, 0, 0, 0};
};

}  // namespace palpate
