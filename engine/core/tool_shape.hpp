// A tool that touches with many points: where they are, and how much of the stiffness each of them has.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Points of a tool, at most.
inline constexpr std::size_t kMaxToolPoints = 64;

enum class ToolKind {
  point,   ///< the HIP itself
  pad,     ///< a disc of rings, round like a fingertip: its foremost place is the HIP, and it curves back from there
  ball,    ///< evenly on a sphere around the HIP
  spatula  ///< a flat grid, half as wide (x) as it is long (y), around the HIP
};
inline constexpr std::array<std::pair<std::string_view, ToolKind>, 4> kToolKinds{
    {{"point", ToolKind::point}, {"pad", ToolKind::pad}, {"ball", ToolKind::ball}, {"spatula", ToolKind::spatula}}};

struct ToolPoint {
  DVec3 place{0};    ///< in the tool's frame, whose origin is the HIP and whose face looks along -z
  double share = 1;  ///< of the tool's stiffness and damping
};

/// Where all points are equally deep the tool is as stiff as one point, since their shares sum up to 1: it is never
/// stiffer. A pad or spatula of two points and more has its balance at the HIP.
struct ToolShape {
  std::vector<ToolPoint> points;  ///< none: the HIP alone
};

/// `size`: diameter of a pad or ball, length of a spatula; places are in its unit. One point is always the HIP. Throws
/// UsageError for a number of points that a tool cannot have, and a size that is not above zero.
ToolShape makeTool(ToolKind kind, std::size_t points, double size);

/// The tool turned the shortest way, so that its face looks along `axis`, which is of any length but zero.
ToolShape facing(ToolShape tool, const DVec3& axis);

/// Whether a turn turns and does nothing else.
bool isTurn(const DQuat& turn);

}  // namespace palpate
