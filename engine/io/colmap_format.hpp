// The points of a COLMAP model as one of the formats.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// Read only. Normals come from normalsFromViews(), with weights from the tracks and errors of points; `error` (pixels)
/// and `track_length` of each point are kept as attributes. The orientation of the cameras determines the up axis, if
/// they agree on one.
CloudFormat colmapFormat();

}  // namespace palpate
