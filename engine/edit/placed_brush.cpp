#include "engine/edit/placed_brush.hpp"

#include <algorithm>

namespace palpate {

PlacedBrush::PlacedBrush(const BrushOptions& options, double support, const BrushStroke::Tool& tool)
    : brush_(brushOf(options, support)), tool_(tool), resamples_(options.resample) {}

// Whether it is in the ball or the shaft, with a margin for rounding. Inflate and grab reach points where the stroke
// found them.
bool PlacedBrush::mayAffect(const DVec3& place) const {
  if (kind() == BrushKind::inflate || kind() == BrushKind::grab) return true;
  constexpr double kMargin = 1e-6;
  const bool hasShaft = kind() == BrushKind::push || kind() == BrushKind::carve;
  const DVec3 offset = place - tool_.center;
  const double along = hasShaft ? std::clamp(glm::dot(offset, tool_.outward), 0.0, tool_.shaft) : 0.0;
  const DVec3 fromAxis = offset - along * tool_.outward;
  return glm::dot(fromAxis, fromAxis) <= (1 + kMargin) * brush_.radius * brush_.radius;
}

PlacedBrush::Point PlacedBrush::brushed(const DVec3& place, const DVec3& normal, const Found& found) const {
  const auto brushed = shared::brushed(brush_, tool_, place, normal, found);
  return {brushed.position, brushed.taken != 0};
}

shared::MeasuredPoint PlacedBrush::measured(const Found& found) const { return shared::measured(brush_, tool_, found); }

DVec3 PlacedBrush::smoothed(const DVec3& place, const Found& found, const SurfaceSample& surface) const {
  if (!surface.defined) return place;
  return shared::smoothed(brush_, tool_, place, found.normal, surface.distance, surface.normal);
}

std::uint32_t PlacedBrush::painted(const DVec3& place, const Found& found, std::uint32_t color) const {
  return shared::painted(brush_, tool_, place, found.normal, color);
}

}  // namespace palpate
