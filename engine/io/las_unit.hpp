// The unit of length of a LAS file: what its coordinate system says, as keys of GeoTIFF (OGC 19-008) or as text
// (OGC 18-010).
#pragma once

#include <span>

#include "engine/cloud/length_unit.hpp"
#include "engine/io/las_layout.hpp"

namespace palpate {

/// Metres where a system names no other unit; unknown without a system, and where coordinates are degrees or of a unit
/// that has no name here.
LengthUnit lasUnit(std::span<const LasRecord> records);

}  // namespace palpate
