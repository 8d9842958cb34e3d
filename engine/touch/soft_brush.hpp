// A brush on a soft body.
#pragma once

#include "engine/edit/placed_brush.hpp"
#include "engine/matter/soft_sculpture.hpp"

namespace palpate {

/// One tick of a brush that changes shapes (changesShape()), by the formulas for any cloud: the body yields by the
/// displacements that the brush would give the surface positions. A unit of the brush's lengths is `unit_m`. A stroke
/// finds the surface of a soft body as it is, pressed in by the hand. Returns the measure of the surface under the
/// tool.
SurfaceMeasure sculpt(SoftSculpture& sculpture, const PlacedBrush& brush, double unit_m);

}  // namespace palpate
