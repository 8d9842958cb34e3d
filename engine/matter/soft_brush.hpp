// A brush on a soft body.
#pragma once

#include "engine/edit/placed_brush.hpp"
#include "engine/matter/soft_sculpture.hpp"

namespace palpate {

/// One tick of a brush that works on soft bodies (shared::kShapesBodies), by the formulas for any cloud: the body
/// yields by the displacements that the brush would give its surface positions, as pressed in by the hand. A unit of
/// the brush's lengths is `unit_m`. Returns the measure of the surface under the tool.
SurfaceMeasure sculpt(SoftSculpture& sculpture, const PlacedBrush& brush, double unit_m);

}  // namespace palpate
