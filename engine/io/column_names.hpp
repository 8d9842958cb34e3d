// Names of point columns in files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/length_unit.hpp"

namespace palpate {

/// The name that all formats share for the meaning of `name`, case-insensitive: x for X, Easting, pos_x; nx for
/// normal_x; red for Red. Other names become lower case, without a unit in brackets.
std::string sharedColumnName(std::string_view name);

/// If x, y or z is missing among shared names, renames those of surveys and scanners that are too short to be meant so
/// in every file: e, n and h; x1, y1 and z1.
void nameShortAxes(std::vector<std::string>& shared);

/// The unit of length that a name contains: "X [mm]", "x_mm", "Points_m_XYZ:0".
LengthUnit unitInName(std::string_view name);

/// The name in UTF-8; bytes of other text are taken for Latin-1.
std::string utf8Name(std::string_view name);

}  // namespace palpate
