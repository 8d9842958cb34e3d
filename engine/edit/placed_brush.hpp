// A brush in double precision on the CPU, by the formulas of shaders/shared/brush.h.
#pragma once

#include "engine/contact/surface.hpp"
#include "engine/core/brush.hpp"
#include "engine/core/point_state.hpp"
#include "shaders/shared/brush.h"

namespace palpate {

/// The options as shaders read them. `support`: support radius, model units. Checks their ranges.
shared::Brush sharedBrush(const BrushOptions& options, double support);

/// What a brush does to the points around it, for one position of the hand. Places relative to the cloud's origin,
/// model units.
class PlacedBrush {
 public:
  /// `spring`: from HIP to proxy; `lastHip`: of the tick before; `support`: support radius, model units.
  PlacedBrush(const BrushOptions& options, double support, const DVec3& hip, const DVec3& lastHip, const DVec3& spring);

  BrushKind kind() const { return static_cast<BrushKind>(brush_.kind); }
  /// False where the spring is no longer than tau: nothing yields.
  bool acts() const { return ball_.acts != 0; }
  /// The ball whose points feel the brush: all those nearer than the brush's radius to its centre.
  const DVec3& center() const { return ball_.center; }
  double radius() const { return brush_.radius; }

  struct Point {
    DVec3 position;
    bool taken = false;  ///< it goes away
  };
  /// Where a point goes by what is known of it alone: with every brush but smooth, and paint, which moves nothing.
  /// `normal`: unit. Outside the ball, and where nothing yields, it stays.
  Point brushed(const DVec3& place, const DVec3& normal) const;
  /// Smooth: where a point goes. `surface`: the algebraic sphere that its neighbours define (SurfaceKind::sphere).
  DVec3 smoothed(const DVec3& place, const SurfaceSample& surface) const;
  /// The colour of a point, RGBA8 or 0 for none, after one tick of paint.
  std::uint32_t painted(const DVec3& place, std::uint32_t color) const;

 private:
  shared::BrushOf<double> brush_;
  shared::BrushBallOf<double> ball_;
};

}  // namespace palpate
