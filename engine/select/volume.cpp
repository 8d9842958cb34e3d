#include "engine/select/volume.hpp"

#include <limits>

namespace palpate {

PointBits pointsIn(std::span<const PointState> points, const PointBits& among, const Volume& volume, unsigned threads) {
  return PointBits::where(points.size(), threads,
                          [&](std::size_t i) { return among.test(i) && volume.contains(DVec3(points[i].position)); });
}

Volume boxAround(std::span<const PointState> points, const PointBits& of) {
  DVec3 low(std::numeric_limits<double>::infinity()), high = -low;
  of.set().forEach([&](std::uint64_t point) {
    low = glm::min(low, DVec3(points[point].position));
    high = glm::max(high, DVec3(points[point].position));
  });
  if (!(low.x <= high.x)) return {.half = DVec3(0)};
  return {.centre = 0.5 * (low + high), .half = 0.5 * (high - low)};
}

}  // namespace palpate
