// Lengths and coordinates for display: all digits that are known, and no others.
#pragma once

#include <string>

#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/point_cloud.hpp"
#include "engine/core/units.hpp"

namespace palpate {

inline constexpr int kLengthDigits = 6, kFewLengthDigits = 3;
/// With at least `digits` significant digits, and all digits of the integer part: never 4.87775e+06.
std::string lengthText(double length, int digits = kLengthDigits);
/// With the unit: "2.31 m", "2.31 units".
std::string lengthText(double length, LengthUnit unit, int digits = kLengthDigits);

/// Size of a model in the hand: "100 mm in the hand for 2.31 m".
std::string touchScaleText(const ModelScale& scale, double longestSide, LengthUnit unit);

/// The smallest difference of coordinates that float32 resolves everywhere in the box, which is relative to the cloud's
/// origin.
double resolutionOf(const Bounds& box);
/// With as many decimals as that resolution justifies, and no trailing zeros; 0: with all 15 digits of double
/// precision.
std::string coordinateText(double coordinate, double resolution);
/// The three coordinates, separated by `between`.
std::string coordinateText(const DVec3& place, double resolution, const std::string& between);

}  // namespace palpate
