// Points as lines of text, which every program of scans can write.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// A point a line: numbers with blanks, tabs, commas or semicolons between them (TextWords), and `#` or `//` before
/// what is no point. A line before the first point may name the columns as a PLY file names properties: x y z, nx ny
/// nz, red green blue (or r g b), in any case, also as surveyors and spreadsheets name them, and any others, which are
/// carried along. Without one, three columns are places, four have an intensity behind them, seven colours behind that,
/// and six have normals where those of all points have length one, or colours where none is negative. Written with that
/// line wherever there is more than a place.
CloudFormat xyzFormat();
/// The same with commas, and names always; read with any sign between numbers.
CloudFormat csvFormat();
/// The number of points before those of each scan; x y z, an intensity, red green blue.
CloudFormat ptsFormat();

}  // namespace palpate
