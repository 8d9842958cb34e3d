// A device without a hand: plays a path and stores the force.
#pragma once

#include "haptics/devices/haptic_device.hpp"
#include "haptics/path.hpp"

namespace palpate {

/// Its own unit is the model's, so the workspace map is the identity.
class PathDevice final : public HapticDevice {
 public:
  explicit PathDevice(Path path) : path_(std::move(path)) {}

  std::string_view name() const override { return "path"; }
  /// No motor and no hand can be harmed, and a script may jump: the trace shows what the user has asked for.
  DeviceLimits limits() const override;
  DeviceState read(double time_s) noexcept override;
  bool write(const DVec3& force_N) noexcept override;
  void emergencyStop() noexcept override {}  // it has no motors
  std::string faultText() const override { return {}; }

  const Path& path() const { return path_; }
  DVec3 lastForce_N() const { return lastForce_N_; }

 private:
  Path path_;
  DVec3 lastForce_N_{0};
};

}  // namespace palpate
