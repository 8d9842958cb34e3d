// The last stage of a force before it reaches a hand.
#pragma once

#include <cstdint>
#include <limits>

#include "engine/core/vec.hpp"
#include "haptics/devices/haptic_device.hpp"

namespace palpate {

/// How long a motor may be driven beyond its continuous force.
/// The heat of the motors in a first-order model: copper loss grows with the square of the current and so of the force,
/// and heat dissipates with one time constant. Scaled so that the continuous force holds a heat of 1. A session starts
/// with cold motors.
class ThermalBudget {
 public:
  /// A peak or continuous force that is not above zero allows no force. Infinite forces are never limited.
  ThermalBudget(double peakForce_N, double continuousForce_N) noexcept;

  /// The maximum force that may be given now, N: the peak while there is room, reduced to the continuous force as the
  /// heat approaches 1, and restored as the motors cool.
  double allowed_N() const noexcept;

  /// A force of this size acted for `dt_s`.
  void spend(double force_N, double dt_s) noexcept;

  /// True while heat limits the force to less than the peak.
  bool isWarm() const noexcept { return allowed_N() < peak_N_; }
  template <class Visit>
  void visitState(Visit& visit) noexcept {
    visit(heat_);
  }

 private:
  double peak_N_ = 0, continuous_N_ = 0;
  double heat_ = 0;  ///< 1: held by the continuous force
};

/// Facts about a tick that decide on its force.
struct TickSigns {
  bool on = true;        ///< the user wants forces
  bool answered = true;  ///< the query gave a valid answer
  bool fresh = true;     ///< from this tick's own query
  /// Age of the data of an answer that is not fresh, if it is known.
  double age_s = std::numeric_limits<double>::infinity();
  bool jumped = false;  ///< the device moved faster than any hand
  /// Share of a force that the age of the information about a surface permits, if others change it (InformationAge).
  double known = 1;
  double demand_N = 0;  ///< magnitude of the force of spring and damper, before any limit
};

/// Ticks at which the gate reduced the force; each is zero in a good session.
struct GateCounts {
  std::uint64_t errors = 0;  ///< times that an error closed the gate
  std::uint64_t stale = 0;   ///< ticks at which the force faded because its data were old
  std::uint64_t aged = 0;    ///< ticks at which it was reduced because there was no news of the surface for long
  std::uint64_t hot = 0;     ///< ticks at which the heat of the motors limited the force
};

/// Passes a force whole, in part or not at all:
/// - none while forces are off, at an error (no valid answer, a jump of the device, a pause in the ticks, a force that
///   is not a number), and afterwards while the surface would at once push with more than a small force: at the start
///   of a session, when forces are switched on, after a jump and after a long error;
/// - then a share that ramps up; the share fades while the data are stale or the information about the surface is old;
///   once it is zero, it waits as after a long error;
/// - never more than the device's peak and what its motors bear.
/// A device without a hand starts with the gate open: the first force of a script can be sudden.
class ForceGate {
 public:
  /// `period_s`: nominal time between two ticks.
  ForceGate(const DeviceLimits& limits, double period_s) noexcept;

  /// The force to write, for a tick `dt_s` after the previous one.
  DVec3 pass(const DVec3& wanted_N, const TickSigns& signs, double dt_s) noexcept;

  /// Share of the wanted force that passes now, 0 to 1, before the limit of heat.
  double share() const noexcept { return share_; }
  /// The heat of the motors limited the last force.
  bool isHot() const noexcept { return hot_; }
  const GateCounts& counts() const noexcept { return counts_; }
  template <class Visit>
  void visitState(Visit& visit) noexcept {
    motors_.visitState(visit);
    visit(share_, waiting_, errorFor_s_, staleFor_s_);
  }

 private:
  bool isError(const DVec3& wanted_N, const TickSigns& signs, double dt_s) const noexcept;
  void age(const TickSigns& signs, double dt_s) noexcept;
  void raiseOrFade(double known, double dt_s) noexcept;
  DVec3 limited(const DVec3& force_N, double dt_s) noexcept;

  ThermalBudget motors_;
  double period_s_;
  double share_;
  bool hot_ = false;
  bool waiting_;           ///< for a small demand
  double errorFor_s_ = 0;  ///< duration of the present error; 0 without one
  double staleFor_s_;      ///< age of the data: since the last fresh answer, or less if an answer says so
  GateCounts counts_;
};

}  // namespace palpate
