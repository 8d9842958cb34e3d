// A brush in double precision on the CPU, by the formulas of shaders/shared/brush.h.
#pragma once

#include "engine/contact/surface.hpp"
#include "engine/core/brush.hpp"
#include "engine/core/brush_stroke.hpp"
#include "engine/core/point_state.hpp"
#include "shaders/shared/brush.h"

namespace palpate {

/// What a brush does to the points around it, for one place of its tool. Places relative to the cloud's origin, model
/// units.
class PlacedBrush {
 public:
  /// A point as the stroke found it; its normal: unit.
  using Found = shared::FoundPointOf<double>;

  /// `support`: support radius, model units.
  PlacedBrush(const BrushOptions& options, double support, const BrushStroke::Tool& tool);

  BrushKind kind() const { return static_cast<BrushKind>(brush_.kind); }
  /// Points come and go with it, where the sculpture can.
  bool keepsDensity() const { return keepsDensity_; }
  /// False: nothing yields.
  bool acts() const { return tool_.acts != 0; }
  /// The ball whose points may feel the brush: all those nearer than the radius to its centre.
  const DVec3& center() const { return tool_.middle; }
  double radius() const { return tool_.reach; }
  std::uint32_t stroke() const { return tool_.stroke; }
  const DVec3& outward() const { return tool_.outward; }  ///< unit, the tool's axis

  struct Point {
    DVec3 position;
    bool taken = false;  ///< it goes away
  };
  /// Where a point goes by what is known of it alone: with every brush but smooth, and paint, which moves nothing.
  /// `normal`: as it is now, unit. Out of the tool's reach, and where nothing yields, it stays.
  Point brushed(const DVec3& place, const DVec3& normal, const Found& found) const;
  /// Smooth: where a point goes. `surface`: the algebraic sphere that its neighbours define (SurfaceKind::sphere).
  DVec3 smoothed(const DVec3& place, const Found& found, const SurfaceSample& surface) const;
  /// The colour of a point, RGBA8 or 0 for none, after one edit of paint.
  std::uint32_t painted(const DVec3& place, const Found& found, std::uint32_t color) const;
  /// Whether a point is one of those that are measured; `id`: the same one in each edit.
  bool measures(std::uint32_t id) const { return shared::isSampled(id, tool_.sampling); }
  /// What it says of the surface under the tool.
  shared::MeasuredPoint measured(const Found& found) const;

 private:
  shared::BrushOf<double> brush_;
  BrushStroke::Tool tool_;
  bool keepsDensity_;
};

}  // namespace palpate
