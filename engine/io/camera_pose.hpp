// Where cameras stand, as files and programs write it.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "engine/core/depth_stream.hpp"

namespace palpate {

/// From the four rows of a matrix that takes a camera's places to the world's. A rotation that is one but for rounding
/// is replaced by the nearest one. Throws Error, without a place, for what is not finite, no rotation, or has another
/// last row than 0 0 0 1.
CameraPose cameraPose(const std::array<double, 16>& rows);

/// From a place and a quaternion that is unit but for rounding. Throws Error, without a place, for others.
CameraPose cameraPose(const DVec3& centre, const DQuat& turn);

/// Between two poses: the centre on the line from one to the other, the turn along the shorter arc (Shoemake 1985).
CameraPose between(const CameraPose& from, const CameraPose& to, double share);

/// Numbers that stand in a line, with blanks between them; nothing where there are others than `count`, or what is
/// none.
template <std::size_t count>
std::optional<std::array<double, count>> numbersIn(std::string_view line);
extern template std::optional<std::array<double, 3>> numbersIn<3>(std::string_view);
extern template std::optional<std::array<double, 4>> numbersIn<4>(std::string_view);
extern template std::optional<std::array<double, 8>> numbersIn<8>(std::string_view);

/// Takes the next word, which ends at a blank, off the front of a line; empty where there is none.
std::string_view takeWord(std::string_view& line);

}  // namespace palpate
