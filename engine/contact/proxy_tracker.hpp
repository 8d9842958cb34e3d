#pragma once

#include <algorithm>

#include "engine/contact/surface.hpp"
#include "engine/core/cloud_frame.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

/// Whoever can say where the surface is, in double precision.
class SurfaceField {
 public:
  /// The surface at a place relative to the cloud's origin. `facing`: normal of the face that is felt (SurfaceSums), or
  /// zero.
  virtual SurfaceSample surface(const DVec3& x, const DVec3& facing) const = 0;
  /// Of the face `facing` of that surface, model units per second, where points move.
  virtual DVec3 velocity(const DVec3& /*x*/, const DVec3& /*facing*/) const { return DVec3(0); }

 protected:
  ~SurfaceField() = default;
};

/// How points that move have gone on until a tick.
struct PointsMotion {
  double age_s = 0;        ///< since the time that they are true for; negative while they come there
  double sinceLast_s = 0;  ///< since the tick before
};
/// `last_s`: of the tick before.
inline PointsMotion pointsMotion(double now_s, const PointsTime& points, double last_s) {
  const double from_s = points.true_s - points.comes_s;
  if (now_s < from_s) return {.age_s = -points.comes_s};
  const double until_s = std::min(now_s, points.true_s + points.goOn_s);
  const double since_s = points.comes_s > 0 ? std::max(last_s, from_s) : last_s;
  return {.age_s = until_s - points.true_s, .sinceLast_s = std::max(0.0, until_s - since_s)};
}

/// What shaders/contact/contact_step.comp does from tick to tick, over any surface: contact begins where the HIP's
/// motion crosses the surface, and the proxy tracks the tangent plane (Salisbury and Tarr 1997), held or dragged by
/// friction (Ruspini, Kolarov, Khatib 1997). A sheet is felt at the face that the HIP came from; a HIP that starts
/// within reach behind a surface is not caught until it has been seen in front. Where points move, a tick is taken in
/// the frame of the surface that was felt last: the proxy is carried along, and what crosses what, and slides, is a
/// matter of the relative way. All places relative to the cloud's origin.
class ProxyTracker {
 public:
  /// `radius`: support radius, model units. `friction`: coefficient while the proxy slides.
  explicit ProxyTracker(double radius, double friction = 0) : radius_(radius), friction_(friction) {}

  /// What one tick leaves to the next.
  struct State {
    bool started = false;  ///< false: there was no tick yet
    bool touching = false;
    bool sticks = false;     ///< the proxy has not slid in the last tick
    std::uint32_t face = 0;  ///< shared::kFace...; while touching, the one that is felt
    DVec3 facing{0};         ///< normal of the surface felt last, as the points have it
    DVec3 lastHip{0}, proxy{0};
    DVec3 velocity{0};  ///< of that surface, model units per second
    double time_s = 0;  ///< of the tick
  };
  State state() const { return {started_, touching_, sticks_, face_, facing_, lastHip_, proxy_, velocity_, time_s_}; }
  /// The next tick goes on from here, whoever tracked it so far.
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

  /// One tick, at `now_s`; nothing else needs the times but points that move.
  void follow(const SurfaceField& field, const DVec3& hip, double now_s = 0, const PointsTime& points = {});

  bool touching() const { return touching_; }
  /// It touches nothing, and has not come out of the surface in front.
  bool isLost() const { return !touching_ && face_ == shared::kFaceInside; }
  /// The HIP itself while nothing is touched.
  const DVec3& proxy() const { return proxy_; }
  /// The surface at the proxy; its outside is the face that is felt.
  const SurfaceSample& surface() const { return surface_; }
  /// Of that surface, model units per second; zero where points stand still.
  const DVec3& velocity() const { return velocity_; }

 private:
  void step(const SurfaceField& field, const DVec3& hip);
  void walkFreely(const SurfaceField& field, const DVec3& hip);
  void track(const SurfaceField& field, const DVec3& hip, bool touched);
  SurfaceSample feel(const SurfaceField& field, const DVec3& x);

  double radius_, friction_;
  bool started_ = false;
  bool touching_ = false;
  bool sticks_ = false;     // the proxy has not slid in the last tick
  std::uint32_t face_ = 0;  // shared::kFace...; while touching, the one that is felt
  DVec3 facing_{0};         // normal of the surface felt last, as the points have it
  DVec3 lastHip_{0};
  DVec3 proxy_{0};
  SurfaceSample surface_;
  DVec3 velocity_{0};
  double time_s_ = 0;  // of the last tick
};

}  // namespace palpate
