// Contact felt through a gamepad: a tap at its start, and a hum that grows with the force.
#pragma once

#include <atomic>
#include <thread>

#include "engine/core/units.hpp"
#include "engine/core/vec.hpp"
#include "haptics/devices/dualsense_report.hpp"
#include "haptics/devices/hid_link.hpp"

namespace palpate {

/// Maps forces to motors. Deterministic.
class RumbleShape {
 public:
  /// `share`: of the strongest force, 0 to 1; `contacts`: number started so far. Times must not decrease.
  RumbleMotors at(double time_s, double share, std::uint32_t contacts) noexcept;

 private:
  std::uint32_t contacts_ = 0;
  double tapUntil_s_ = 0;
};

/// The motors of a DualSense, driven by a thread of its own. They stop at the end, when forces are no longer set, and
/// after stop() until resume(). Only kill -9 leaves them as they were.
class Rumble {
 public:
  /// `device`: from chooseDualSense(). A force of `full_N` or more is the strongest hum; if the device has no such
  /// limit, that of a Touch is used. Throws Error.
  Rumble(std::shared_ptr<HidTransport> transport, const HidInfo& device, HidRemark remark,
         double full_N = kTouchPeakForce_N);
  ~Rumble();
  Rumble(const Rumble&) = delete;
  Rumble& operator=(const Rumble&) = delete;

  /// The force of this tick. On one thread; neither blocks nor allocates.
  void setForce(const DVec3& force_N) noexcept;
  /// Async-signal-safe.
  void stop() noexcept;
  void resume() noexcept { stopped_.store(false); }

 private:
  void drive(const std::stop_token& stop);
  void send(RumbleMotors motors);
  void publish() noexcept;
  void withdraw() noexcept;

  double full_N_;
  bool touching_ = false;  // used by the thread that sets forces
  std::atomic<float> share_ = 0;
  std::atomic<std::uint32_t> contacts_ = 0, ticks_ = 0;
  std::atomic<bool> stopped_ = false;
  HidLink link_;  // used by the thread that drives
  RumbleMotors sent_;
  // For stop(), which may be called at any time: the open device, and its current number of users.
  std::array<std::uint8_t, 48> silence_;
  std::atomic<HidConnection*> open_ = nullptr;
  std::atomic<int> users_ = 0;
  std::jthread driver_;
};

}  // namespace palpate
