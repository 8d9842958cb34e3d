// The unit of length of a LAS file according to its coordinate system, given as GeoTIFF keys (OGC 19-008) or as text
// (OGC 18-010).
#pragma once

#include <span>

#include "engine/cloud/length_unit.hpp"
#include "engine/io/las_layout.hpp"

namespace palpate {

/// Metres if the system declares no other unit; unknown without a system, and if coordinates are in degrees or in an
/// unsupported unit.
LengthUnit lasUnit(std::span<const LasRecord> records);

}  // namespace palpate
