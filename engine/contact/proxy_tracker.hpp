#pragma once

#include <algorithm>

#include "engine/contact/surface.hpp"
#include "engine/core/cloud_frame.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

/// A surface in double precision.
class SurfaceField {
 public:
  /// The surface at a position relative to the cloud's origin. `facing`: normal of the face that is felt (SurfaceSums),
  /// or zero.
  virtual SurfaceSample surface(const DVec3& x, const DVec3& facing) const = 0;
  /// Velocity of the face `facing` of that surface, model units per second, if points move.
  virtual DVec3 velocity(const DVec3& /*x*/, const DVec3& /*facing*/) const { return DVec3(0); }

 protected:
  ~SurfaceField() = default;
};

/// Extrapolation of moving points to a tick.
struct PointsMotion {
  double age_s = 0;        ///< since the time for which they are true; negative while they approach it
  double sinceLast_s = 0;  ///< since the previous tick
};
/// `last_s`: time of the previous tick.
inline PointsMotion pointsMotion(double now_s, const PointsTime& points, double last_s) {
  const double from_s = points.true_s - points.comes_s;
  if (now_s < from_s) return {.age_s = -points.comes_s};
  const double until_s = std::min(now_s, points.true_s + points.extrapolationLimit_s);
  const double since_s = points.comes_s > 0 ? std::max(last_s, from_s) : last_s;
  return {.age_s = until_s - points.true_s, .sinceLast_s = std::max(0.0, until_s - since_s)};
}

/// The tracking of shaders/shared/proxy.h from tick to tick, over any surface: contact begins where the
/// HIP's path crosses the surface, and the proxy tracks the tangent plane (Salisbury and Tarr 1997), held or dragged by
/// friction (Ruspini, Kolarov, Khatib 1997). A sheet is felt at the face that the HIP came from; a HIP that starts
/// within reach behind a surface is not caught until it has been in front. If points move, a tick is computed in the
/// frame of the surface felt last: the proxy is carried along, and crossings and slides use relative displacements. All
/// positions relative to the cloud's origin.
class ProxyTracker {
 public:
  /// `radius`: support radius, model units. `friction`: coefficient while the proxy slides.
  explicit ProxyTracker(double radius, double friction = 0) : radius_(radius), friction_(friction) {}

  /// The state passed from one tick to the next.
  struct State {
    bool started = false;  ///< false before the first tick
    bool touching = false;
    bool sticks = false;     ///< the proxy did not slide in the last tick
    std::uint32_t face = 0;  ///< shared::kFace...; while touching, the face that is felt
    DVec3 facing{0};         ///< normal of the surface felt last, at the points' time
    DVec3 lastHip{0}, proxy{0};
    DVec3 velocity{0};  ///< of that surface, model units per second
    double time_s = 0;  ///< of the tick
  };
  State state() const { return {started_, touching_, sticks_, face_, facing_, lastHip_, proxy_, velocity_, time_s_}; }
  /// Continues from a state of another tracker.
  void goOnFrom(const State& state) {
    started_ = state.started;
    touching_ = state.touching;
    sticks_ = state.sticks;
    facing_ = state.facing;
    face_ = state.face;
    lastHip_ = state.lastHip;
    proxy_ = state.proxy;
    velocity_ = state.velocity;
    time_s_ = state.time_s;
  }

  /// One tick, at `now_s`; the times matter only for moving points.
  void follow(const SurfaceField& field, const DVec3& hip, double now_s = 0, const PointsTime& points = {});

  bool touching() const { return touching_; }
  /// Nothing is touched, and the HIP has not returned to the front of the surface.
  bool isLost() const { return !touching_ && face_ == shared::kFaceInside; }
  /// Equals the HIP while nothing is touched.
  const DVec3& proxy() const { return proxy_; }
  /// The surface at the proxy; its outside is the face that is felt.
  const SurfaceSample& surface() const { return surface_; }
  /// Velocity of that surface, model units per second; zero where points stand still.
  const DVec3& velocity() const { return velocity_; }

 private:
  void step(const SurfaceField& field, const DVec3& hip);
  SurfaceSample feel(const SurfaceField& field, const DVec3& x, bool fromBehind);

  double radius_, friction_;
  bool started_ = false;
  bool touching_ = false;
  bool sticks_ = false;     // the proxy did not slide in the last tick
  std::uint32_t face_ = 0;  // shared::kFace...; while touching, the face that is felt
  DVec3 facing_{0};         // normal of the surface felt last, at the points' time
  DVec3 lastHip_{0};
  DVec3 proxy_{0};
  SurfaceSample surface_{};
  DVec3 velocity_{0};
  double time_s_ = 0;  // of the last tick
};

}  // namespace palpate
