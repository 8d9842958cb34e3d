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
  /// Maximum rate at which the force may grow or rotate. Its size may fall at once, except where a surface is lost
  /// under a hand that is still inside: there it falls no faster than it may grow.
  double maxRise_N_per_s = 600;
  /// Maximum power of a moving surface on the hand: its velocity times the force. 2 N at half a metre per second.
  double maxSurfacePower_W = 1;

  bool operator==(const ForceOptions&) const = default;
};

/// A custom force law: the force on the hand, N, for one tick of contact. `usual_N`: that of spring and damper. Called
/// on the servo thread; must not allocate, block or throw.
struct CustomForce {
  DVec3 (*function)(void* user, const Contact& contact, const Pose& pose, double dt_s,
                    const DVec3& usual_N) noexcept = nullptr;
  void* user = nullptr;

  explicit operator bool() const { return function != nullptr; }
};

/// Keeps the state of the last tick; one per session.
class ForceLaw {
 public:
  /// Throws UsageError for an option that is negative or not finite (those that begin with max may be infinite).
  ForceLaw(const ForceOptions& options, const ModelScale& scale);

  const ForceOptions& options() const { return options_; }
  const ModelScale& scale() const { return scale_; }

  /// From now on `custom` gives the force of a contact, in place of spring and damper; every limit stays, except that
  /// it may also pull. It does not apply to a tool of many points.
  void setCustom(const CustomForce& custom) { custom_ = custom; }

  /// Lowers maxForce_N and the stiffness to what a device bears.
  void limitTo(double peakForce_N, double stiffness_N_per_mm = std::numeric_limits<double>::infinity()) noexcept;

  /// Others are changing the surface under the proxy: meanwhile the force rises at a tenth of the rate of the hand's
  /// own pressing, so that no change is felt as a knock.
  void setChanging(bool isChanging) noexcept { isChanging_ = isChanging; }

  /// The force on the hand, N, for a tick `dt_s` after the previous one. Exactly zero if nothing is touched, on any
  /// fault or non-finite number, and if spring and damper together would pull into the surface. If the contact states
  /// the force itself, that is used, within the same limits.
  DVec3 update(const Contact& contact, const Pose& pose, double dt_s) noexcept;

  /// Allocates for a tool of that many points.
  void feelWith(std::size_t points) { pointRates_.resize(points); }

  /// The same for a tool: each point has its share of spring and damper and only pushes, and the limits act on the sum.
  /// Exactly zero while `whole`, the combined answer, touches nothing or is a fault.
  DVec3 update(const Contact& whole, std::span<const PointContact> points, const Pose& pose, double dt_s) noexcept;

  /// Torque of the forces on a tool's points, as summed up by update(): about the HIP, mN m, reduced in proportion if a
  /// limit reduced the force. For a single point, the torque that the contact states, as for a ball in matter;
  /// otherwise zero.
  const DVec3& torque_mNm() const noexcept { return torque_mNm_; }

  /// Magnitude of the demand of spring and damper at the last tick, before any limit, N.
  double demand_N() const noexcept { return demand_N_; }

  /// Resets the contact, as if nothing had been touched yet.
  void reset() noexcept;

 private:
  /// Rate of a point's spring, and of its hand, mm/s.
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
  bool isLettingGo_ = false;  ///< of a lost surface
};

}  // namespace palpate
