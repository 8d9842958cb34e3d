// A brush on a soft body.
#pragma once

#include "engine/edit/placed_brush.hpp"
#include "engine/matter/soft_sculpture.hpp"

namespace palpate {

/// One tick of a brush that changes shapes (changesShape()), by the formulas of any cloud: what it would do to the
/// places of the surface is what the body yields by. A unit of the brush's lengths is `unit_m`. How many nodes have
/// moved.
std::size_t sculpt(SoftSculpture& sculpture, const PlacedBrush& brush, double unit_m);

}  // namespace palpate
