#include "apps/cli/probe_overlays.hpp"

namespace palpate {

namespace {

// Sizes of the drawn probe, mm on a model of 100 mm.
constexpr double kBallRadius_mm = 1.2, kDiscRadius_mm = 2.5, kArrow_mm_per_N = 15, kShaftRadius_mm = 0.5;

/// Position of a brush's tool in contact (BrushOptions).
Overlays::Ball ballOf(const BrushOptions& brush, const DVec3& hip, const DVec3& proxy) {
  const DVec3 spring = proxy - hip;
  const bool standsBefore = brushHas(brush.kind, shared::kHasShaft);
  const DVec3 outward = glm::length(spring) > 0 ? glm::normalize(spring) : DVec3(0);
  return {standsBefore ? hip + (brush.yieldDepth + brush.radius) * outward : proxy, brush.radius};
}

}  // namespace

Overlays overlaysOf(const TraceRow& row, const DVec3& origin, double longestSide, const HeldTool& tool) {
  const double unitsPer_mm = longestSide / kDefaultLongestSide_mm;
  const auto units = [&](double mm) { return mm * unitsPer_mm; };
  Overlays overlays;
  overlays.hip = {row.hip - origin, units(kBallRadius_mm)};
  if (tool.ballRadius > 0) overlays.brush = {row.proxy - origin, tool.ballRadius};
  if (!row.contact) return overlays;
  const DVec3 proxy = row.proxy - origin;
  overlays.proxy = {proxy, row.normal, units(kDiscRadius_mm)};
  overlays.force = {proxy, row.force_N * units(kArrow_mm_per_N), units(kShaftRadius_mm)};
  if (tool.brush) overlays.brush = ballOf(*tool.brush, row.hip - origin, proxy);
  return overlays;
}

}  // namespace palpate
