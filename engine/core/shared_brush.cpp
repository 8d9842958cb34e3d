// Brushes, tools and measures of the surface in the formats that C++ and shaders share.
#include <algorithm>
#include <iterator>

#include "engine/core/brush_stroke.hpp"
#include "engine/core/check.hpp"
#include "engine/core/point_state.hpp"

namespace palpate {

static_assert(packedColor(kUnpainted) == shared::kUnpainted);

shared::BrushOf<double> brushOf(const BrushOptions& options, double support) {
  PALPATE_CHECK_LE(0.0, options.yieldDepth);
  PALPATE_CHECK_LE(0.0, options.pushRate);
  PALPATE_CHECK_LE(options.pushRate, 1.0);
  PALPATE_CHECK_LT(0.0, options.radius);
  PALPATE_CHECK_LE(0.0, options.strength);
  PALPATE_CHECK_LE(options.strength, 1.0);
  PALPATE_CHECK_LE(options.falloff, kMaxFalloff);
  PALPATE_CHECK_LT(0.0, support);
  const bool buildsUp = options.accumulate && brushHas(options.kind, shared::kMayBuildUp);
  return {.kind = static_cast<shared::uint>(options.kind),
          .traits = traitsOf(options.kind).traits | (buildsUp ? shared::kBuildsUp : 0),
          .falloff = options.falloff,
          .radius = options.radius,
          .longestMove = static_cast<double>(shared::kLongestMove) * support,
          .support = support,
          .color = packedColor(options.color)};
}

shared::Brush sharedBrush(const BrushOptions& options, double support) {
  const auto brush = brushOf(options, support);
  return {.kind = brush.kind,
          .traits = brush.traits,
          .falloff = brush.falloff,
          .radius = static_cast<float>(brush.radius),
          .longestMove = static_cast<float>(brush.longestMove),
          .support = static_cast<float>(brush.support),
          .color = brush.color};
}

shared::BrushTool sharedTool(const BrushStroke::Tool& tool) {
  return {.center = Vec3(tool.center),
          .acts = tool.acts,
          .outward = Vec3(tool.outward),
          .shaft = static_cast<float>(tool.shaft),
          .motion = Vec3(tool.motion),
          .share = static_cast<float>(tool.share),
          .middle = Vec3(tool.middle),
          .reach = static_cast<float>(tool.reach),
          .hand = Vec3(tool.hand),
          .hearing = static_cast<float>(tool.hearing),
          .height = static_cast<float>(tool.height),
          .stroke = tool.stroke,
          .sampling = tool.sampling,
          .closes = tool.closes,
          .cell = static_cast<float>(tool.cell),
          .touched = Vec3(tool.touched),
          .entersFrom = Vec3(tool.entersFrom),
          .connectedFrom = Vec3(tool.connectedFrom),
          .ownSide = Vec3(tool.ownSide),
          .ownFrom = static_cast<float>(tool.ownFrom),
          .isImage = tool.isImage};
}

shared::PlacedTool placedTool(const BrushStroke::Tool& tool) {
  shared::PlacedTool placed{.tool = sharedTool(tool), .connected = {}};
  std::ranges::copy(tool.connected, std::begin(placed.connected));
  return placed;
}

void SurfaceMeasure::add(const shared::MeasuredPoint& point) {
  weights += static_cast<std::uint32_t>(point.weight);
  for (int k = 0; k < 3; ++k) normals[static_cast<std::size_t>(k)] += static_cast<std::uint32_t>(point.normal[k]);
  heights += static_cast<std::uint32_t>(point.height);
}

void SurfaceMeasure::add(const SurfaceMeasure& other) {
  weights += other.weights;
  for (std::size_t k = 0; k < normals.size(); ++k) normals[k] += other.normals[k];
  heights += other.heights;
  blocked += other.blocked;
  for (std::size_t k = 0; k < seen.size(); ++k) seen[k] |= other.seen[k];
  nearest = std::min(nearest, other.nearest);
}

void SurfaceMeasure::enter(shared::uint entered) {
  if (entered == shared::kOutsideSheet) return;
  const shared::uint cell = entered % shared::kSheetCells;
  seen[cell / 32] |= 1u << cell % 32;
  nearest = std::min(nearest, entered);
}

SurfaceMeasure operator-(const SurfaceMeasure& a, const SurfaceMeasure& b) {
  SurfaceMeasure gap{.weights = a.weights - b.weights,
                     .normals = {},
                     .heights = a.heights - b.heights,
                     .blocked = a.blocked - b.blocked,
                     .seen = a.seen,
                     .nearest = a.nearest};
  for (std::size_t k = 0; k < 3; ++k) gap.normals[k] = a.normals[k] - b.normals[k];
  return gap;
}

}  // namespace palpate
