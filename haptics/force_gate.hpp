// The last thing a force passes before it reaches a hand.
#pragma once

#include <cstdint>
#include <limits>

#include "engine/core/vec.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/thermal_budget.hpp"

namespace palpate {

/// What a tick knows about its own force.
struct TickSigns {
  bool on = true;        ///< the user wants forces
  bool answered = true;  ///< the query gave a valid answer
  bool fresh = true;     ///< from this tick's own query
  /// How old the data of an answer that is not fresh are, as far as it says so.
  double age_s = std::numeric_limits<double>::infinity();
  bool jumped = false;  ///< the device moved faster than any hand
  /// The share of a force that what is known of the surface bears, where others change it, too (InformationAge).
  double known = 1;
  double demand_N = 0;  ///< size of the force that spring and damper ask for, before any limit
};

/// Ticks at which the gate held something back; each is zero in a good session.
struct GateCounts {
  std::uint64_t errors = 0;  ///< times that an error closed the gate
  std::uint64_t stale = 0;   ///< ticks at which the force faded because its data were old
  std::uint64_t aged = 0;    ///< ticks at which it was less because nobody has said for long how the surface is
  std::uint64_t hot = 0;     ///< ticks at which the motors' heat held the force down
};

/// Lets a force pass whole, in part or not at all:
/// - nothing while forces are off, at an error (no valid answer, a jump of the device, a pause in the ticks, a force
///   that is no number), and afterwards while the surface would at once push with more than a small force: at the start
///   of a session, when forces come back, after a jump and after a long error;
/// - then a share that ramps up; and a share that fades while the data are stale, or what is known of the surface is
/// old:
///   where nothing is left of it, it waits as after a long error;
/// - never more than the device's peak and what its motors bear.
/// A device without a hand starts with the gate open: nobody is surprised by a script's first force.
class ForceGate {
 public:
  /// `period_s`: the time between two ticks when none is late.
  ForceGate(const DeviceLimits& limits, double period_s) noexcept;

  /// The force to write, for a tick that comes `dt_s` after the one before.
  DVec3 pass(const DVec3& wanted_N, const TickSigns& signs, double dt_s) noexcept;

  /// The share of the wanted force that passes now, 0 to 1, heat aside.
  double share() const noexcept { return share_; }
  const GateCounts& counts() const noexcept { return counts_; }

 private:
  bool isError(const DVec3& wanted_N, const TickSigns& signs, double dt_s) const noexcept;
  void age(const TickSigns& signs, double dt_s) noexcept;
  void raiseOrFade(double known, double dt_s) noexcept;
  DVec3 limited(const DVec3& force_N, double dt_s) noexcept;

  ThermalBudget motors_;
  double period_s_;
  double share_;
  bool waiting_;           ///< for a small demand
  double errorFor_s_ = 0;  ///< how long the present error has lasted; 0 without one
  double staleFor_s_;      ///< age of the data: since the last fresh answer, or less if an answer says so
  GateCounts counts_;
};

}  // namespace palpate
