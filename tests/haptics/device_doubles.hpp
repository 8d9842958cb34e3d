// A device whose poses, limits and faults a test sets, and which keeps the forces written to it.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "haptics/devices/haptic_device.hpp"

namespace palpate {

class ScriptedDevice : public HapticDevice {
 public:
  using States = std::function<DeviceState(double time_s)>;
  explicit ScriptedDevice(States states, const DeviceLimits& limits = {}, std::string name = "scripted")
      : states_(std::move(states)), limits_(limits), name_(std::move(name)) {}

  std::string_view name() const override { return name_; }
  DeviceLimits limits() const override { return limits_; }
  DeviceState read(double time_s) noexcept override {
    now_s_ = time_s;
    return states_(time_s);
  }
  bool write(const DVec3& force_N) noexcept override {
    last_N = force_N;
    most_N = std::max(most_N, glm::length(force_N));
    return now_s_ < failsWriteAt_s;
  }
  void emergencyStop() noexcept override { stopped = true; }
  std::string faultText() const override { return text; }

  double failsWriteAt_s = 1e9;
  std::string text;
  DVec3 last_N{9};
  double most_N = 0;
  bool stopped = false;

 private:
  States states_;
  DeviceLimits limits_;
  std::string name_;
  double now_s_ = 0;
};

}  // namespace palpate
