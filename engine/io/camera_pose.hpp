// Poses of cameras, as files and programs write them.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "engine/core/depth_stream.hpp"

namespace palpate {

/// From the four rows of a camera-to-world matrix. Rounding errors of the rotation are removed. Throws Error, without a
/// location, for entries that are not finite, a matrix that is not a rotation, or a last row other than 0 0 0 1.
CameraPose cameraPose(const std::array<double, 16>& rows);

/// From a position and a quaternion of unit length except for rounding. Throws Error, without a location, for others.
CameraPose cameraPose(const DVec3& centre, const DQuat& turn);

/// Interpolates between two poses: the centre linearly, the rotation along the shorter arc (Shoemake 1985).
CameraPose between(const CameraPose& from, const CameraPose& to, double share);

/// Numbers in a line, separated by blanks; nothing unless there are exactly `count` valid numbers.
template <std::size_t count>
std::optional<std::array<double, count>> numbersIn(std::string_view line);
extern template std::optional<std::array<double, 3>> numbersIn<3>(std::string_view);
extern template std::optional<std::array<double, 4>> numbersIn<4>(std::string_view);
extern template std::optional<std::array<double, 8>> numbersIn<8>(std::string_view);
extern template std::optional<std::array<double, 12>> numbersIn<12>(std::string_view);
extern template std::optional<std::array<double, 16>> numbersIn<16>(std::string_view);

/// Takes the next word (delimited by blanks) off the front of a line; empty at the end.
std::string_view takeWord(std::string_view& line);

}  // namespace palpate
