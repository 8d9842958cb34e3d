#include "engine/edit/placed_brush.hpp"

namespace palpate {

PlacedBrush::PlacedBrush(const BrushOptions& options, double support, const BrushStroke::Tool& tool)
    : brush_(brushOf(options, support)), tool_(tool), resamples_(options.resample) {}

bool PlacedBrush::actsOn(const Found& found) const {
  return has(shared::kRemovesPoints) || hasCell(tool_.connected, shared::connectedCell(tool_, found));
}

PlacedBrush::Point PlacedBrush::brushed(const DVec3& place, const DVec3& normal, const Found& found) const {
  const auto brushed = shared::brushed(brush_, tool_, place, normal, found);
  if (brushed.position != place && !actsOn(found)) return {place};
  return {brushed.position, brushed.taken != 0};
}

bool PlacedBrush::movesAlong(const Seen& seen) const {
  if (seen.isOfStroke || seen.stays) return seen.isOfStroke;
  return !(glm::distance(seen.position, tool_.middle) < tool_.reach) || actsOn({seen.position, seen.normal, 0});
}

PlacedBrush::Path PlacedBrush::path(const DVec3& place, const Found& found, double spacing) const {
  return shared::pathOf(brush_, tool_, place, found, spacing);
}

double PlacedBrush::freeUntil(const Path& path, const Seen& seen, double free) const {
  const DVec3 offset = seen.position - path.position;
  if (!shared::isBeside(path, offset)) return free;
  // For most neighbours it does not matter whether the brush moves them.
  const double along = shared::freeUntil(brush_, tool_, path, {offset, seen.normal, true}, free);
  const double staying = shared::freeUntil(brush_, tool_, path, {offset, seen.normal, false}, free);
  return along == staying || movesAlong(seen) ? along : staying;
}

double PlacedBrush::freeBeside(const Path& path, const DVec3& place, const Found& blocked, double free) const {
  return shared::freeBeside(brush_, path, place - path.position, blocked.position - place, blocked.normal, free);
}

bool PlacedBrush::isInNoWay(const Seen& seen) const {
  return shared::isInNoWay(brush_, tool_, seen.normal) && movesAlong(seen);
}

shared::MeasuredPoint PlacedBrush::measured(const Found& found) const { return shared::measured(brush_, tool_, found); }

void PlacedBrush::measure(const DVec3& place, const Found& found, SurfaceMeasure& measure) const {
  if (const shared::MeasuredPoint point = measured(found); point.weight != 0 && actsOn(found)) measure.add(point);
  measure.enter(shared::entered(brush_, tool_, place, found));
}

bool PlacedBrush::smooths(const DVec3& place, const Found& found) const {
  return shared::brushShare(brush_, tool_, place, found.normal) > 0 && actsOn(found);
}

DVec3 PlacedBrush::smoothed(const DVec3& place, const Found& found, const SurfaceSample& surface) const {
  if (!surface.defined || !actsOn(found)) return place;
  return shared::smoothed(brush_, tool_, place, found, surface.distance, surface.normal);
}

std::uint32_t PlacedBrush::painted(const DVec3& place, const Found& found, std::uint32_t color) const {
  const std::uint32_t painted = shared::painted(brush_, tool_, place, found, color);
  return painted != color && actsOn(found) ? painted : color;
}

}  // namespace palpate
