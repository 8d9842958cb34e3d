// One hand in a session: its device and its force.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "engine/core/contact_query.hpp"
#include "haptics/clutch.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/hand_force.hpp"
#include "haptics/trace.hpp"

namespace palpate {

struct HandOptions {
  WorkspaceMap map;                        ///< initial; the device's clutch moves it
  std::optional<PassivityMode> passivity;  ///< default: on for a device in a hand, off for a script
};

/// Results of a hand's session beside its rows.
struct HandCounts {
  GateCounts withheld;
  std::optional<double> leastEnergy_mJ;  ///< minimum of the energy that the surface has taken in; see Passivity
};

/// Per tick, in this order: read(), feel(), write(), note().
class Hand {
 public:
  /// The device must outlive it. The force is limited to the device's peak. `toolPoints`: number of points of its tool;
  /// 0 for the HIP alone. Throws UsageError for a passivity controller on a device that does not yield to forces.
  Hand(HapticDevice& device, ForceLaw law, const HandOptions& options, double rate_Hz, std::size_t toolPoints);

  HapticDevice& device() const noexcept { return *device_; }
  /// The device's fault, as a sentence.
  std::string faultText() const;
  HandCounts counts() const;

  /// Starts a session.
  void begin();

  /// Reads the device. False if that failed.
  bool read(double time_s) noexcept;
  const DeviceState& state() const noexcept { return state_; }
  const DVec3& hip() const noexcept { return hip_; }  ///< model units
  /// Whether it is to change what it touches; if it has buttons, while one of them is held.
  bool sculpts() const noexcept;
  bool hasButtons() const noexcept { return limits_.buttons > 0; }

  /// Computes the force of an answer, to be written. `points`: of a tool.
  void feel(const Contact& answer, std::span<const PointContact> points, const Pose& pose, double dt_s,
            const TickConditions& conditions) noexcept;
  /// False if the force did not reach the device.
  bool write() noexcept;
  /// Force at the last tick.
  const FeltForce& felt() const noexcept { return felt_; }
  /// Cancels the force of this tick: another device failed.
  void takeForceAway() noexcept;
  /// Records this tick.
  void note(TraceRow& row) const noexcept;

  /// Replaces the options of its force law, within the limits of its device, and the gain of the hand: the HIP stays.
  /// Between ticks.
  void setForce(const ForceOptions& options) noexcept;
  template <class Visit>
  void visitState(Visit& visit) noexcept {
    force_.visitState(visit);
    clutch_.visitState(visit);
    visit(lastPosition_);
    force_.visitProxy(visit);
    visit(felt_.asked_N, felt_.got_N);
  }

 private:
  /// Only of a device that is held: a script says where the HIP is.
  double gainOf(const ForceOptions& options) const noexcept { return limits_.handHeld ? options.handGain : 1; }
  /// Whether the device moved faster than a hand can since the last tick.
  bool hasJumped(const DVec3& position, double dt_s) noexcept;

  HapticDevice* device_;
  WorkspaceMap map_;
  DeviceLimits limits_;
  PassivityMode passivityMode_;
  HandForce force_;
  Clutch clutch_;
  std::optional<DVec3> lastPosition_;  ///< of the device, in its own unit

  // State of this tick.
  DeviceState state_;
  DVec3 hip_{0};
  bool written_ = false;
  FeltForce felt_;
};

}  // namespace palpate
