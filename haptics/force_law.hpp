// From contact to force: a spring and a damper between the HIP and the proxy, and the limits that keep it safe.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "engine/core/contact_query.hpp"
#include "engine/core/units.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// Rate of change of a value, from samples in steps.
/// A backward difference over the last tick, or over enough ticks to span a millisecond: an encoder step of 55 um looks
/// like 55 mm/s over a millisecond, but like 550 mm/s over a tick of 10 kHz, which a damper would turn into knocks.
class RateEstimate {
 public:
  /// The rate of change per second up to `value`, `dt_s` after the previous one; zero for the first.
  DVec3 add(const DVec3& value, double dt_s) noexcept;

  void reset() noexcept { count_ = 0; }
  template <class Visit>
  void visitState(Visit& visit) noexcept {
    for (Sample& sample : samples_) visit(sample.value, sample.dt_s);
    visit(newest_, count_);
  }

 private:
  static constexpr std::size_t kMax = 16;  // ticks in a difference: a millisecond up to 16 kHz

  struct Sample {
    DVec3 value;
    double dt_s;  ///< since the previous one
  };
  std::array<Sample, kMax + 1> samples_{};
  std::size_t newest_ = 0, count_ = 0;
};

/// Bounds of ForceOptions::handGain.
inline constexpr double kMinHandGain = 0.05, kMaxHandGain = 4;

struct ForceOptions {
  double stiffness_N_per_mm = 0.8;
  double damping_N_s_per_mm = 0.002;
  double maxForce_N = kTouchPeakForce_N;
  /// Maximum rate at which the force may grow or rotate with the hand's own motion; its size may fall at once with it.
  /// What the surface alone does changes the force, in size and direction, at a tenth of this rate at most.
  double maxRise_N_per_s = 600;
  /// Maximum power of a moving surface on the hand: its velocity times the force. 2 N at half a metre per second.
  double maxSurfacePower_W = 1;
  /// Motion of the stylus for a motion of a hand that holds the device (Clutch): 1 at the scale of the workspace.
  double handGain = 1;

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

/// Throws UsageError for an option that is negative or not finite (those that begin with max may be infinite).
void validate(const ForceOptions& options);

/// Keeps the state of the last tick; one per session.
class ForceLaw {
 public:
  /// Throws as validate() does.
  ForceLaw(const ForceOptions& options, const ModelScale& scale);

  const ForceOptions& options() const { return options_; }
  const ModelScale& scale() const { return scale_; }

  /// From now on `custom` gives the force of a contact, in place of spring and damper; every limit stays, except that
  /// it may also pull. It does not apply to a tool of many points.
  void setCustom(const CustomForce& custom) { custom_ = custom; }

  /// Replaces the options, before limitTo(). What this changes about the force counts as the surface's: it follows at a
  /// tenth of maxRise_N_per_s.
  void setOptions(const ForceOptions& options) noexcept { options_ = options; }

  /// Lowers maxForce_N and the stiffness to what a device bears.
  void limitTo(double peakForce_N, double stiffness_N_per_mm = std::numeric_limits<double>::infinity()) noexcept;

  /// The force on the hand, N, for a tick `dt_s` after the previous one. Each tick brings it closer to what spring and
  /// damper ask for, which is nothing where nothing is touched and where they would pull into the surface: by as much
  /// as the hand's motion in this tick changes a spring and a damper on a surface at rest, and by a tenth of
  /// maxRise_N_per_s. So a hand that withdraws is free at once, and a surface that ends or changes is not felt as a
  /// knock. Exactly zero at once on any fault or non-finite number. In the first tick after reset() the motion is
  /// unknown and counts as the hand's. If the contact states the force itself, that is used, within the same limits.
  DVec3 update(const Contact& contact, const Pose& pose, double dt_s) noexcept;

  /// Allocates for a tool of that many points.
  void feelWith(std::size_t points) { toolPoints_.resize(points); }

  /// The same for a tool: each point has its share of spring and damper and only pushes, and the limits act on the sum.
  /// Nothing is asked for while `whole`, the combined answer, touches nothing.
  DVec3 update(const Contact& whole, std::span<const PointContact> points, const Pose& pose, double dt_s) noexcept;

  /// Torque of the forces on a tool's points, as summed up by update(): about the HIP, mN m, reduced in proportion if a
  /// limit reduced the force. For a single point, the torque that the contact states, as for a ball in matter;
  /// otherwise zero.
  const DVec3& torque_mNm() const noexcept { return torque_mNm_; }

  /// Magnitude of the demand of spring and damper at the last tick, before any limit, N.
  double demand_N() const noexcept { return demand_N_; }

  /// Resets the contact, as if nothing had been touched yet.
  void reset() noexcept;

  template <class Visit>
  void visitState(Visit& visit) noexcept {
    const auto visitPoint = [&](Point& point) {
      point.stretch.visitState(visit), point.hand.visitState(visit);
      visit(point.hip_mm, point.hand_mm_per_s);
    };
    visitPoint(point_);
    for (Point& point : toolPoints_) visitPoint(point);
    visit(asked_N_, followed_N_, force_N_, torque_mNm_, demand_N_, isMoveKnown_);
  }

 private:
  /// A point that touches, as the last tick left it.
  struct Point {
    RateEstimate stretch, hand;  ///< rate of its spring, and of itself, mm/s, while it touches
    DVec3 hip_mm{0};
    DVec3 hand_mm_per_s{0};
  };
  /// What the hand's motion in this tick changes a spring and a damper by: the sum over the points, and of their sizes.
  struct HandPart {
    DVec3 along_N{0};
    double most_N = 0;
  };
  void move(Point& point, const DVec3& hip, bool touching, double share, double dt_s) noexcept;
  DVec3 spring(const Contact& contact, Point& point, double dt_s) const noexcept;
  DVec3 felt(const DVec3& target_N, const DVec3& velocity, double demand_N, double dt_s) noexcept;
  void follow(const DVec3& target_N, double dt_s) noexcept;
  DVec3 rise(double dt_s) noexcept;
  DVec3 fault() noexcept;

  ForceOptions options_;
  ModelScale scale_;
  CustomForce custom_;
  Point point_;
  std::vector<Point> toolPoints_;
  HandPart hand_;
  double asked_N_ = 0;   ///< at the last tick, within the limits of a force
  DVec3 followed_N_{0};  ///< what is asked for, without the jumps of the surface
  DVec3 force_N_{0};     ///< at the last tick
  DVec3 torque_mNm_{0};
  double demand_N_ = 0;
  bool isMoveKnown_ = false;  ///< hand_; not in the first tick after reset()
};

}  // namespace palpate
