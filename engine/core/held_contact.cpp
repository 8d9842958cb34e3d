#include "engine/core/held_contact.hpp"

namespace palpate {

Contact combined(Contact whole, std::span<const PointContact> points, const DVec3& hip) {
  if (points.empty()) return whole;
  DVec3 spring(0), normals(0), velocities(0), first(0);
  double ways = 0;
  whole.touching = false;
  for (const PointContact& point : points) {
    const Contact& contact = point.contact;
    whole.valid = whole.valid && contact.valid;
    whole.fresh = whole.fresh && contact.fresh;
    whole.neighbours = std::max(whole.neighbours, contact.neighbours);
    if (!contact.touching) continue;
    if (!whole.touching) {
      first = contact.normal;
      whole.velocity = contact.velocity;
    }
    whole.touching = true;
    if (!contact.fresh) whole.dataTime_s = std::min(whole.dataTime_s, contact.dataTime_s);  // the oldest one
    const DVec3 way = point.share * (contact.proxy - point.hip);
    spring += way;
    normals += glm::length(way) * contact.normal;
    velocities += glm::length(way) * contact.velocity;
    ways += glm::length(way);
  }
  whole.proxy = hip + spring;
  // Points that have just reached the surface, or are pressed from all sides, have no mean.
  if (ways > 0) whole.velocity = velocities / ways;
  const double length = glm::length(normals);
  if (whole.touching) whole.normal = length > 0 ? normals / length : first;
  return whole;
}

}  // namespace palpate
