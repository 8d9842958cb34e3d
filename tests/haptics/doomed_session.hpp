// A session that crashes during touch, for programs that must end by it; its device's record is in memory that outlives
// them.
#pragma once

#include <algorithm>
#include <functional>

#include "tests/fake_devices/fake_device.hpp"
#include "tests/haptics/contact_doubles.hpp"

namespace palpate {

/// A hand that moves 2 mm into the sphere within 0.7 s and stays; its motors keep the last force until the next one.
class RecordingDevice final : public HapticDevice {
 public:
  explicit RecordingDevice(FakeNote& note) : note_(note) {}
  std::string_view name() const override { return "recording"; }
  DeviceLimits limits() const override { return {}; }
  DeviceState read(double time_s) noexcept override {
    return {.position = {0, 0, std::max(48.0, 51.5 - 5 * time_s)}, .ok = true};
  }
  bool write(const DVec3& force_N) noexcept override {
    note_.force_N[2] = glm::length(force_N);
    note_.mostForce_N = std::max(note_.mostForce_N, note_.force_N[2]);
    return true;
  }
  void emergencyStop() noexcept override {
    note_.force_N[2] = 0;
    ++note_.closed;
  }
  std::string faultText() const override { return {}; }

 private:
  FakeNote& note_;
};

/// Runs `doom` 0.9 s into the session, in the middle of a tick.
class DoomedSphere final : public ContactQuery {
 public:
  explicit DoomedSphere(std::function<void()> doom, std::size_t hands = 1) : sphere_(hands), doom_(std::move(doom)) {}
  std::size_t hands() const noexcept override { return sphere_.hands(); }
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override {
    if (poses.front().time_s >= 0.9 && !done_) {
      done_ = true;
      doom_();
    }
    return sphere_.ask(poses, budget_us);
  }

 private:
  SharedSphere sphere_;
  std::function<void()> doom_;
  bool done_ = false;
};

/// The force was felt, and removed once when the program ended.
inline void checkStopped(const FakeNote& note) {
  CHECK(note.mostForce_N > 1);
  CHECK(note.force_N[2] == 0);
  CHECK(note.closed == 1);
}

}  // namespace palpate
