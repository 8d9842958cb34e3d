// The unit of a file's lengths, for display: scale bars, heights, sizes. It does not scale the model; the number of
// millimetres per unit in the hand does.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate {

enum class LengthUnit : std::uint8_t { unknown, mm, cm, m, inch, foot };

/// Names on the command line.
inline constexpr std::array<std::pair<std::string_view, LengthUnit>, 5> kLengthUnits{{{"mm", LengthUnit::mm},
                                                                                      {"cm", LengthUnit::cm},
                                                                                      {"m", LengthUnit::m},
                                                                                      {"in", LengthUnit::inch},
                                                                                      {"ft", LengthUnit::foot}}};
/// "units" if unknown.
std::string_view nameOf(LengthUnit unit);

/// The unit of this many mm, as inch for 25.4; unknown for any other number.
LengthUnit unitOfScale(double mm_per_unit);
/// The mm of a unit; empty if it is unknown.
std::optional<double> mmIn(LengthUnit unit);
/// The unit in a file's comments, as in `comment units: mm` or `obj_info unit = metres`, else the unit of the scale in
/// them (scaleSaidIn()); unknown if they contain neither.
LengthUnit unitSaidIn(std::span<const std::string> comments);
/// Writes the unit into the comments, replacing any other.
void setUnit(std::vector<std::string>& comments, LengthUnit unit);
/// Adds the unit to the comments, for formats whose files have a fixed unit; an existing unit stays.
void sayUnit(std::vector<std::string>& comments, LengthUnit unit);

/// Millimetres per unit, as in `comment mm_per_unit: 137.2`; empty if missing or not a positive number.
std::optional<double> scaleSaidIn(std::span<const std::string> comments);
/// Adds the scale to the comments, replacing any other, and the touch scale.
void sayScale(std::vector<std::string>& comments, double mm_per_unit);
/// The mm per unit in the hand, as in `comment touch_scale: 0.52`: of a part of a model, that of the whole. Unlike
/// mm_per_unit it says nothing about the unit of length.
std::optional<double> touchScaleSaidIn(std::span<const std::string> comments);
void setTouchScale(std::vector<std::string>& comments, double mm_per_unit);

/// The longest of 1, 2, 5, 10, … units, of 0.1, 0.2, 0.5 and so on, that is at most `length`; 0 if `length` is not
/// positive.
double roundLength(double length);

}  // namespace palpate
