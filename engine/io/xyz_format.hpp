// Points as lines of text, which every program of scans can write.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// A point a line: numbers with blanks, tabs, commas or semicolons between them, and `#` or `//` before what is no
/// point. A line before the first point may name the columns as a PLY file names properties: x y z, nx ny nz, red green
/// blue (or r g b), and any others, which are carried along. Without one, three columns are places, four have an
/// intensity behind them, seven colours behind that, and six have normals where the first point's has length one, or
/// colours where it has whole numbers up to 255. Written with that line wherever there is more than a place.
CloudFormat xyzFormat();
/// The same with commas, and names always; read with any sign between numbers.
CloudFormat csvFormat();
/// The number of points before those of each scan; x y z, an intensity, red green blue.
CloudFormat ptsFormat();

}  // namespace palpate
