#pragma once

#include "engine/contact/surface_reference.hpp"

namespace palpate {

/// Whoever can say where the surface is, in double precision.
class SurfaceField {
 public:
  /// The surface at a place relative to the cloud's origin.
  virtual SurfaceSample surface(const DVec3& x) const = 0;

 protected:
  ~SurfaceField() = default;
};

/// What shaders/contact/contact_step.comp does from tick to tick, over any surface: contact begins where the HIP's
/// motion crosses the surface from outside, and the proxy tracks the tangent plane (Salisbury and Tarr 1997). All
/// places relative to the cloud's origin.
class ProxyTracker {
 public:
  /// `radius`: support radius, model units.
  explicit ProxyTracker(double radius) : radius_(radius) {}

  /// What one tick leaves to the next.
  struct Story {
    bool started = false;  ///< false: there was no tick yet
    bool touching = false;
    std::uint32_t side = 0;  ///< shared::kSide...
    DVec3 lastHip{0}, proxy{0};
  };
  Story story() const { return {started_, touching_, side_, lastHip_, proxy_}; }
  /// The next tick goes on from here, whoever told it so far.
  void goOnFrom(const Story& story) {
    started_ = story.started;
    touching_ = story.touching;
    side_ = story.side;
    lastHip_ = story.lastHip;
    proxy_ = story.proxy;
  }

  /// One tick.
  void follow(const SurfaceField& field, const DVec3& hip);

  bool touching() const { return touching_; }
  /// The HIP itself while nothing is touched.
  const DVec3& proxy() const { return proxy_; }
  /// The surface at the proxy.
  const SurfaceSample& surface() const { return surface_; }

 private:
  void walkFreely(const SurfaceField& field, const DVec3& hip);
  void track(const SurfaceField& field, const DVec3& hip);

  double radius_;
  bool started_ = false;
  bool touching_ = false;
  std::uint32_t side_ = 0;  // shared::kSide...
  DVec3 lastHip_{0};
  DVec3 proxy_{0};
  SurfaceSample surface_;
};

}  // namespace palpate
