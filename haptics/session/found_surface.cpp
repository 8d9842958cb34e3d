#include "haptics/session/found_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {

namespace {

constexpr double kBeside = 4;  // distance of the depths that give slope and normal, pixels of the picture
// A slope is measured by the discs of the points, which are rough; a surface is steeper between them.
constexpr double kSteeper = 2, kSteepest = 4;

}  // namespace

DVec3 normalAt(const Pick& pick, const Camera& camera, const DVec2& size_px) {
  const DVec3 place = camera.unproject(pick.place_px, pick.depth, size_px);
  const DVec3 toEye = camera.towardsViewer(place);
  // Of the two positions beside it, the one nearer in depth is on the same surface.
  const auto along = [&](std::size_t first, const DVec2& way_px) -> std::optional<DVec3> {
    std::optional<DVec3> best;
    double least = 0;
    for (const std::size_t k : {first, first + 1}) {
      if (!(pick.beside[k] > 0)) continue;
      const double side = k == first ? -1 : 1, gap = std::abs(pick.beside[k] - pick.depth);
      if (best && gap >= least) continue;
      least = gap;
      best = side * (camera.unproject(pick.place_px + side * way_px, pick.beside[k], size_px) - place);
    }
    return best;
  };
  if (!(pick.depth > 0)) return toEye;
  const auto right = along(0, {pick.beside_px, 0}), down = along(2, {0, pick.beside_px});
  if (!right || !down) return toEye;
  const DVec3 normal = glm::cross(*down, *right);
  const double length = glm::length(normal);
  if (!(length > 0)) return toEye;
  // A normal seen at a grazing angle is unreliable.
  constexpr double kMinTowardsEye = 0.3;
  const DVec3 facing = (glm::dot(normal, toEye) < 0 ? -1.0 : 1.0) / length * normal;
  return glm::dot(facing, toEye) < kMinTowardsEye ? toEye : facing;
}

std::optional<FoundSpot> FoundSurface::at(const DVec2& place_px) const {
  Pick pick{.place_px = place_px, .depth = picture_.depthAt(place_px), .beside_px = kBeside * picture_.shrink};
  if (!(pick.depth > 0)) return std::nullopt;
  const DVec2 ways[]{{-pick.beside_px, 0}, {pick.beside_px, 0}, {0, -pick.beside_px}, {0, pick.beside_px}};
  for (std::size_t k = 0; k < pick.beside.size(); ++k) pick.beside[k] = picture_.depthAt(place_px + ways[k]);
  const auto gentler = [&](std::size_t first) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t k : {first, first + 1})
      if (pick.beside[k] > 0) least = std::min(least, std::abs(pick.beside[k] - pick.depth) / pick.beside_px);
    return std::isfinite(least) ? least : 0;
  };
  const DVec3 place = picture_.camera.unproject(place_px, pick.depth, picture_.size_px);
  return FoundSpot{.place = place,
                   .outward = normalAt(pick, picture_.camera, picture_.size_px),
                   .toEye = picture_.camera.towardsViewer(place),
                   .depth = pick.depth,
                   .slope = std::hypot(gentler(0), gentler(2))};
}

bool FoundSurface::isStep(const FoundSpot& a, const FoundSpot& b, double way_px, double allowed) const {
  const double aside = picture_.camera.pixelSize(std::min(a.depth, b.depth), picture_.size_px.y);  // of a pixel
  const double explained = way_px * std::max(kSteepest * aside, kSteeper * std::max(a.slope, b.slope));
  return std::abs(a.depth - b.depth) > allowed + explained;
}

DVec3 FoundSurface::inPlane(const FoundSpot& spot, const DVec2& place_px) const {
  return picture_.camera.unproject(place_px, spot.depth, picture_.size_px);
}

}  // namespace palpate
