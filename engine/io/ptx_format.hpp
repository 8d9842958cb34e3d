// PTX, Leica's text of structured scans (Cyclone, "PTX format"): of each scan its grid, its place and its points.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// A scan is its columns and rows, its scanner's place and axes, a matrix of four rows whose last one moves, and a line
/// for each point: x y z, an intensity, and maybe red green blue. (0 0 0) is no echo: such are left out and counted.
/// All scans become one cloud, each where its matrix puts it. It is only read.
CloudFormat ptxFormat();

}  // namespace palpate
