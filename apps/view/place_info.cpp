#include "apps/view/place_info.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "apps/view/session.hpp"
#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/file_coordinates.hpp"
#include "engine/cloud/length_text.hpp"

namespace palpate {

namespace {

// The nearest existing point; null if there is none.
const PointState* nearestTo(std::span<const PointState> points, const DVec3& place) {
  const PointState* nearest = nullptr;
  double least2 = std::numeric_limits<double>::infinity();
  for (const PointState& point : points) {
    if (point.gone) continue;
    const DVec3 apart = DVec3(point.position) - place;
    const double distance2 = glm::dot(apart, apart);
    if (!(distance2 < least2)) continue;
    least2 = distance2;
    nearest = &point;
  }
  return nearest;
}

std::string textOf(const Attribute& attribute, std::size_t point) {
  return visitScalar(attribute.type, [&]<class T>(std::type_identity<T>) {
    T value{};
    std::memcpy(&value, attribute.data.data() + point * sizeof(T), sizeof(T));
    if constexpr (sizeof(T) == 1)
      return fmt::format("{}", static_cast<int>(value));
    else
      return fmt::format("{}", value);
  });
}

// The hand's spring and the soft body act in series.
void findStiffness(const WindowSession& session, PlaceInfo& info) {
  const double hand = session.feel().stiffness_N_per_mm;
  const SessionConfig& config = session.config();
  if (!config.model.matter) {
    info.stiffness_N_mm = hand;
    info.stiffnessOf = "the hand's spring; the model is rigid";
    return;
  }
  const BodyStiffness body =
      config.model.matter->stiffness(0.5 * session.model().scale.toMm(session.session().surface().radius));
  info.stiffnessOf = body.why;
  if (!body.why.empty()) return;
  info.stiffness_N_mm = 1 / (1 / hand + 1 / body.N_per_mm);
  info.stiffnessOf =
      fmt::format("the hand's spring, {:.3g} N/mm, in series with a half-space, {:.3g} N/mm", hand, body.N_per_mm);
}

/// The history has the present state of each point.
bool knowsAll(const WindowSession& session) { return !session.config().moves() && session.session().pointHistory(); }

}  // namespace

PickedPosition pickedAt(const WindowSession& session, const DVec3& place, double pixel) {
  constexpr double kNear_px = 5;
  const PointState* const point = knowsAll(session) ? nearestTo(session.history().points(), place) : nullptr;
  if (point && glm::distance(DVec3(point->position), place) <= kNear_px * pixel) return {DVec3(point->position), 0};
  const double step = std::pow(10.0, std::floor(std::log10(pixel)));
  const DVec3& origin = session.model().cloud.origin;
  return {step * glm::round((origin + place) / step) - origin, step};
}

PlaceInfo placeInfo(const WindowSession& session, const PickedPosition& picked) {
  const PointCloud& cloud = session.model().cloud;
  const DVec3& place = picked.place;
  const double exact = resolutionOf(session.bounds());
  PlaceInfo info{.place = cloud.origin + place, .resolution = std::max(exact, picked.resolution)};
  findStiffness(session, info);
  if (!knowsAll(session)) return info;
  const PointState* const point = nearestTo(session.history().points(), place);
  if (point == nullptr) return info;
  info.point = point->number;
  info.position = cloud.origin + DVec3(point->position);
  info.positionResolution = exact;
  info.normal = point->normal;
  if (cloud.hasColors())
    info.attributes.emplace_back(
        "colour", fmt::format("{}, {}, {}", point->color & 255, point->color >> 8 & 255, point->color >> 16 & 255));
  // A point added later has the attributes of its parent.
  if (const std::size_t file = point->parent; file < cloud.size()) {
    if (isExact(cloud) && cloud.positions[file] == point->position) {
      info.position = cloud.fileCoordinates(file);
      info.positionResolution = 0;
    }
    for (const Attribute& attribute : cloud.extra)
      info.attributes.emplace_back(attribute.name, textOf(attribute, file));
  }
  return info;
}

}  // namespace palpate
