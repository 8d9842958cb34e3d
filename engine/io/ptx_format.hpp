// PTX, Leica's text format of structured scans (Cyclone, "PTX format"): grid, pose and points of each scan.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// A scan has its numbers of columns and rows, its scanner's position and axes, a matrix of four rows, the last one of
/// which is the translation, and a line for each point: x y z, an intensity, and optionally red green blue. (0 0 0)
/// means no echo: such points are left out and counted. All scans become one cloud, transformed by their matrices. Read
/// only.
CloudFormat ptxFormat();

}  // namespace palpate
