// A tool that touches with many points: their positions and their shares of the stiffness.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Maximum number of points of a tool.
inline constexpr std::size_t kMaxToolPoints = 64;

enum class ToolKind {
  point,  ///< the HIP itself
  pad,    ///< a disc of rings, curved like a fingertip: its foremost position is the HIP, and it curves back from there
  ball,   ///< points evenly on a sphere around the HIP
  spatula  ///< a flat grid, half as wide (x) as it is long (y), around the HIP
};
inline constexpr std::array<std::pair<std::string_view, ToolKind>, 4> kToolKinds{
    {{"point", ToolKind::point}, {"pad", ToolKind::pad}, {"ball", ToolKind::ball}, {"spatula", ToolKind::spatula}}};

struct ToolPoint {
  DVec3 place{0};    ///< in the tool's frame, whose origin is the HIP and whose face looks along -z
  double share = 1;  ///< of the tool's stiffness and damping
};

/// Shares sum to 1: a tool whose points are all equally deep is as stiff as one point, and it is never stiffer. A pad
/// or spatula of two or more points is balanced about the HIP.
struct ToolShape {
  std::vector<ToolPoint> points;  ///< empty: the HIP alone
};

/// `size`: diameter of a pad or ball, length of a spatula; positions are in its unit. A single point is always the HIP.
/// Throws UsageError for an invalid number of points, or a size that is not above zero.
ToolShape makeTool(ToolKind kind, std::size_t points, double size);

/// The tool rotated by the smallest angle so that its face looks along `axis`, which may have any length but zero.
ToolShape facing(ToolShape tool, const DVec3& axis);

/// Whether a quaternion is a pure rotation (of unit length).
bool isTurn(const DQuat& turn);

}  // namespace palpate
