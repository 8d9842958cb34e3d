// The points of a COLMAP model as one of the formats.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// Read only. Normals are those of normalsFromViews(), where points count by what their tracks and errors make of their
/// places; `error` (pixels) and `track_length` of each point are carried along. Which way the cameras were held says
/// what is up, where they agree on an axis.
CloudFormat colmapFormat();

}  // namespace palpate
