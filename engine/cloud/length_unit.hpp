// The unit of a file's lengths, for what people read: scale bars, heights, sizes. It scales nothing; what does is the
// number of millimetres that a unit is in the hand.
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

/// As on the command line.
inline constexpr std::array<std::pair<std::string_view, LengthUnit>, 5> kLengthUnits{{{"mm", LengthUnit::mm},
                                                                                      {"cm", LengthUnit::cm},
                                                                                      {"m", LengthUnit::m},
                                                                                      {"in", LengthUnit::inch},
                                                                                      {"ft", LengthUnit::foot}}};
/// "units" for an unknown one.
std::string_view nameOf(LengthUnit unit);

/// That of so many mm, as 25.4 are an inch; unknown for any other number.
LengthUnit unitOfScale(double mm_per_unit);
/// What a file's comments say, as in `comment units: mm` or `obj_info unit = metres`, or else that of the scale that
/// they say (scaleSaidIn()); unknown where none says it.
LengthUnit unitSaidIn(std::span<const std::string> comments);
/// Has the comments say it, in the place of any other unit.
void setUnit(std::vector<std::string>& comments, LengthUnit unit);
/// Has the comments say it, as a format does whose files have one unit; what a comment says already stays.
void sayUnit(std::vector<std::string>& comments, LengthUnit unit);

/// How many millimetres a unit is, as in `comment mm_per_unit: 137.2`; nothing where none says it, or no positive
/// number.
std::optional<double> scaleSaidIn(std::span<const std::string> comments);
/// Has the comments say that, in the place of any other scale.
void sayScale(std::vector<std::string>& comments, double mm_per_unit);

/// The longest of 1, 2, 5, 10, … units, of 0.1, 0.2, 0.5 and so on, that is at most `length`; 0 where that is not
/// positive.
double roundLength(double length);

}  // namespace palpate
