#include "engine/core/tool_shape.hpp"

#include <algorithm>
#include <numbers>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kRoundness = 1;     // of a pad: radius of its curvature over its diameter, about that of a fingertip
constexpr double kSlenderness = 2;   // of a spatula: length over width
constexpr double kUnitSlack = 1e-3;  // of a rotation that a device reports in single precision or less

// Sizes of the rings for `count` points, each ring in the middle of the area that its points stand for. A ring has at
// least two points: one alone would be off balance.
std::vector<std::size_t> ringSizes(std::size_t count) {
  std::vector<std::size_t> rings;
  std::size_t left = count;
  if (count > 3) {
    rings.push_back(1);
    --left;
  }
  std::size_t number = 0;
  while (3 * number * (number + 1) < left) ++number;
  std::size_t weights = number * (number + 1) / 2;
  for (std::size_t ring = 1; ring <= number; ++ring) {
    const std::size_t size = ring == number ? left : std::max<std::size_t>(2, (left * ring + weights / 2) / weights);
    rings.push_back(size);
    left -= size;
    weights -= ring;
  }
  return rings;
}

std::vector<ToolPoint> padPoints(std::size_t count, double size) {
  std::vector<ToolPoint> points;
  const double share = 1.0 / static_cast<double>(count), roundness = kRoundness * size;
  for (const std::size_t inRing : ringSizes(count)) {
    const double covered = (static_cast<double>(points.size()) + 0.5 * static_cast<double>(inRing)) * share;
    const double r = inRing == 1 ? 0 : 0.5 * size * std::sqrt(covered);
    const double back = roundness - std::sqrt(roundness * roundness - r * r);
    for (std::size_t i = 0; i < inRing; ++i) {
      const double angle = kTurn * static_cast<double>(i) / static_cast<double>(inRing);
      points.push_back({{r * std::cos(angle), r * std::sin(angle), back}, share});
    }
  }
  return points;
}

// The Fibonacci sphere (Swinbank, Purser 2006): equal steps in height, the golden angle around.
std::vector<ToolPoint> ballPoints(std::size_t count, double size) {
  std::vector<ToolPoint> points;
  const double share = 1.0 / static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double z = (2 * static_cast<double>(i) + 1) * share - 1, across = std::sqrt(1 - z * z);
    const double angle = kTurn * std::numbers::phi * static_cast<double>(i);
    points.push_back({0.5 * size * DVec3(across * std::cos(angle), across * std::sin(angle), z), share});
  }
  return points;
}

std::vector<ToolPoint> spatulaPoints(std::size_t count, double size) {
  std::vector<ToolPoint> points;
  const auto rows = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(count) / kSlenderness))));
  const double rowShare = 1.0 / static_cast<double>(rows);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t inRow = (row + 1) * count / rows - row * count / rows;
    const double share = 1.0 / static_cast<double>(inRow);
    const double x = size / kSlenderness * ((static_cast<double>(row) + 0.5) * rowShare - 0.5);
    for (std::size_t i = 0; i < inRow; ++i)
      points.push_back({{x, size * ((static_cast<double>(i) + 0.5) * share - 0.5), 0}, rowShare * share});
  }
  return points;
}

}  // namespace

ToolShape makeTool(ToolKind kind, std::size_t points, double size) {
  if (points < 1 || points > kMaxToolPoints)
    throw UsageError("a tool of {} points: 1 to {} are supported", points, kMaxToolPoints);
  if (!(size > 0) || !std::isfinite(size))
    throw UsageError("a tool of size {}: it must be finite and above zero", size);
  if (points == 1 || kind == ToolKind::point) {
    if (points > 1)
      throw UsageError("a point tool of {} points: it has exactly one; choose another tool for more", points);
    return {.points = {ToolPoint{}}};
  }
  switch (kind) {
    case ToolKind::pad:
      return {padPoints(points, size)};
    case ToolKind::ball:
      return {ballPoints(points, size)};
    case ToolKind::spatula:
    case ToolKind::point:
      break;
  }
  return {spatulaPoints(points, size)};
}

ToolShape facing(ToolShape tool, const DVec3& axis) {
  const double length = glm::length(axis);
  if (!(length > 0) || !std::isfinite(length))
    throw UsageError("the axis ({}, {}, {}) of a tool has no direction", axis.x, axis.y, axis.z);
  const DVec3 to = axis / length, from(0, 0, -1);
  const double cosine = glm::dot(from, to);
  if (cosine >= 1) return tool;
  // For opposite directions the shortest rotation is not unique: rotates about x.
  const DQuat turn = cosine > -1 + 1e-12 ? glm::normalize(DQuat(1 + cosine, glm::cross(from, to))) : DQuat(0, 1, 0, 0);
  for (ToolPoint& point : tool.points) point.place = turn * point.place;
  return tool;
}

bool isTurn(const DQuat& turn) { return std::abs(glm::dot(turn, turn) - 1) < kUnitSlack; }

}  // namespace palpate
