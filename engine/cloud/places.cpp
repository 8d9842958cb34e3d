#include "engine/cloud/places.hpp"

#include <algorithm>
#include <numeric>

#include "engine/core/check.hpp"
#include "engine/core/stop_checks.hpp"

namespace palpate {

Places distinctPlaces(std::span<const Vec3> points) {
  PALPATE_CHECK_LT(points.size(), std::size_t{1} << 32);
  struct Entry {
    Vec3 position;
    std::uint32_t point;
  };
  std::vector<Entry> entries(points.size());
  for (std::uint32_t i = 0; i < entries.size(); ++i) entries[i] = {points[i], i};
  std::sort(entries.begin(), entries.end(), [checks = StopChecks()](const Entry& a, const Entry& b) mutable {
    checks();
    if (a.position.x != b.position.x) return a.position.x < b.position.x;
    if (a.position.y != b.position.y) return a.position.y < b.position.y;
    return a.position.z < b.position.z;
  });
  Places places;
  places.placeOf.resize(points.size());
  StopChecks checks;
  for (const Entry& entry : entries) {
    checks();
    if (places.positions.empty() || places.positions.back() != entry.position)
      places.positions.push_back(entry.position);
    places.placeOf[entry.point] = static_cast<std::uint32_t>(places.positions.size() - 1);
  }
  return places;
}

}  // namespace palpate
