#include "engine/matter/soft_brush.hpp"

#include "engine/core/check.hpp"

namespace palpate {

namespace {

// Radius of the surface positions that support a position's surface, in cell spacings: as many as the points of any
// cloud.
const double kSupport_cells = static_cast<double>(shared::kSupportSpacings) / kPlacesOfSpacing;

struct NowPlace {
  std::uint32_t number;
  DVec3 place;  // model units
  Vec3 normal;
};

}  // namespace

SurfaceMeasure sculpt(SoftSculpture& sculpture, const PlacedBrush& brush, double unit_m) {
  PALPATE_CHECK(brush.has(shared::kShapesBodies));
  SurfaceMeasure measure;
  if (!brush.acts()) return measure;
  const SoftBody& body = sculpture.body();
  const SoftSurface& surface = sculpture.surface();
  const bool smooths = brush.has(shared::kUsesNeighbours);
  const double support = kSupport_cells * body.lattice().spacing_m() / unit_m;
  const double reach = brush.radius() + (smooths ? support : 0);
  std::vector<NowPlace> near;
  for (std::uint32_t i = 0; i < surface.size(); ++i)
    if (const DVec3 place = DVec3(surface.placeOf(body, i)) / unit_m; glm::distance(place, brush.center()) < reach)
      near.push_back({.number = i, .place = place, .normal = surface.normalOf(body, i)});
  std::vector<PlaceWay> ways;
  for (const NowPlace& at : near) {
    if (!(glm::distance(at.place, brush.center()) < brush.radius())) continue;
    const PlacedBrush::Found found{at.place, DVec3(at.normal), double{shared::kUnseen}};
    if (brush.measures(at.number)) brush.measure(at.place, found, measure);
    DVec3 to;
    if (smooths) {
      const auto forEachNear = [&](double radius, auto&& visit) {
        for (const NowPlace& other : near)
          if (const DVec3 offset = other.place - at.place; glm::length(offset) < radius) visit(offset, other.normal);
      };
      to = brush.smoothed(at.place, found,
                          surfaceOf({.radius = support, .kind = SurfaceKind::sphere}, DVec3(at.normal), forEachNear));
    } else {
      to = brush.brushed(at.place, DVec3(at.normal), found).position;
    }
    if (to != at.place) ways.push_back({.place = at.number, .way = unit_m * (to - at.place)});
  }
  sculpture.yield(ways);
  return measure;
}

}  // namespace palpate
