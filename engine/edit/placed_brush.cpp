#include "engine/edit/placed_brush.hpp"

namespace palpate {

PlacedBrush::PlacedBrush(const BrushOptions& options, double support, const BrushStroke::Tool& tool)
    : brush_(brushOf(options, support)), tool_(tool), resamples_(options.resample) {}

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
