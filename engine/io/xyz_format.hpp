// Points as lines of text, which all scanning programs can write.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// A point per line: numbers separated by blanks, tabs, commas or semicolons (TextWords); lines that begin with `#` or
/// `//` are comments. A line before the first point may name the columns like PLY properties: x y z, nx ny nz, red
/// green blue (or r g b), case-insensitive and with the names of surveyors and spreadsheets; any other columns are kept
/// as attributes, or named as lost if they contain words. Up to 20 title lines may precede it. Without names, columns
/// behind x y z are determined by all rows (UnnamedColumns), and reported as assumed (StoredCloud::assumed). Writing
/// adds the line of names if there are other columns than positions.
CloudFormat xyzFormat();
/// The same with commas, and always with names; any separator is accepted when reading.
CloudFormat csvFormat();
/// Each scan is preceded by its number of points; columns are x y z, an intensity, red green blue.
CloudFormat ptsFormat();

}  // namespace palpate
