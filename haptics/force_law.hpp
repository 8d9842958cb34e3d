// From contact to force: a spring and a damper between the HIP and the proxy, and the limits that keep it safe.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "engine/core/contact_query.hpp"
#include "engine/core/units.hpp"
#include "haptics/rate_estimate.hpp"

namespace palpate {

struct ForceOptions {
  double stiffness_N_per_mm = 0.8;
  double damping_N_s_per_mm = 0.002;
  double maxForce_N = kTouchPeakForce_N;
  /// How fast the force may grow or turn. Its size may fall at once, but where a surface is lost under a hand that is
  /// still within: there it falls no faster than it may grow.
  double maxRise_N_per_s = 600;
  /// What a surface that moves by itself may do to the hand: its velocity times the force. 2 N at half a metre per
  /// second.
  double maxSurfacePower_W = 1;

  bool operator==(const ForceOptions&) const = default;
};

/// A force law of another program's: the force on the hand, N, for one tick of contact. `usual_N` is that of spring and
/// damper. On the servo thread; it allocates nothing, waits for nobody and throws nothing.
struct CustomForce {
  DVec3 (*function)(void* user, const Contact& contact, const Pose& pose, double dt_s,
                    const DVec3& usual_N) noexcept = nullptr;
  void* user = nullptr;

  explicit operator bool() const { return function != nullptr; }
};

/// Remembers the last tick; one per session.
class ForceLaw {
 public:
  /// Throws UsageError for an option that is negative or not finite (those that begin with max may be infinite).
  ForceLaw(const ForceOptions& options, const ModelScale& scale);

  const ForceOptions& options() const { return options_; }
  const ModelScale& scale() const { return scale_; }

  /// From now on the force of a contact is what `custom` says, in place of spring and damper; every limit stays, but
  /// that it may pull as well. It has no say in the force of a tool of many points.
  void setCustom(const CustomForce& custom) { custom_ = custom; }

  /// Lowers maxForce_N and the stiffness to what a device can bear.
  void limitTo(double peakForce_N, double stiffness_N_per_mm = std::numeric_limits<double>::infinity()) noexcept;

  /// Somebody else is changing the surface under the proxy: while that is so, what comes of it rises ten times as
  /// slowly as the hand's own pressing may, so that no change knocks on the hand.
  void setChanging(bool isChanging) noexcept { isChanging_ = isChanging; }

  /// The force on the hand, N, for a tick that comes `dt_s` after the one before. Exactly zero when nothing is touched,
  /// on any fault or number that is not finite, and when spring and damper together would pull into the surface. Where
  /// the contact says the force itself, it is that, within the same limits.
  DVec3 update(const Contact& contact, const Pose& pose, double dt_s) noexcept;

  /// Makes room for a tool of so many points.
  void feelWith(std::size_t points) { pointRates_.resize(points); }

  /// The same for a tool: each point has its share of spring and damper and only pushes, and the limits act on the sum.
  /// Exactly zero while `whole`, the answer as a whole, touches nothing or is a fault.
  DVec3 update(const Contact& whole, std::span<const PointContact> points, const Pose& pose, double dt_s) noexcept;

  /// What a tool's forces on its points, which update() has summed up, turn the hand with: about the HIP, mN m, and
  /// less in proportion where a limit took from the force. So for a single point where the contact says a torque, as a
  /// ball's in matter does; otherwise zero.
  const DVec3& torque_mNm() const noexcept { return torque_mNm_; }

  /// The size of what spring and damper asked for at the last tick, before any limit, N.
  double demand_N() const noexcept { return demand_N_; }

  /// Forgets the contact, as if nothing had been touched yet.
  void reset() noexcept;

 private:
  /// How fast the spring of a point stretches, and its hand goes, mm/s.
  struct Rates {
    RateEstimate stretch, hand;
    void reset() noexcept { stretch.reset(), hand.reset(); }
  };
  DVec3 spring(const Contact& contact, const DVec3& hip, double dt_s, Rates& rates) const noexcept;
  DVec3 letGo(double dt_s) noexcept;
  DVec3 given(const DVec3& force_N, const DVec3& velocity, double dt_s) noexcept;
  DVec3 limited(const DVec3& target_N, const DVec3& velocity, double dt_s) noexcept;

  ForceOptions options_;
  ModelScale scale_;
  CustomForce custom_;
  Rates rates_;
  std::vector<Rates> pointRates_;  ///< of a tool
  DVec3 force_N_{0};               ///< at the last tick
  DVec3 torque_mNm_{0};
  double demand_N_ = 0;
  bool isChanging_ = false;
  bool isLettingGo_ = false;  ///< of a surface that was lost
};

}  // namespace palpate
