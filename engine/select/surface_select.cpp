#include "engine/select/surface_select.hpp"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <limits>

#include "engine/core/parallel_collect.hpp"
#include "engine/spatial/sorted_grid.hpp"

namespace palpate {

namespace {

/// Positions by cells. From many threads.
class Cells {
 public:
  Cells(std::vector<Vec3> positions, std::span<const std::uint8_t> there, double radius, unsigned threads)
      : positions_(std::move(positions)),
        radius_(radius),
        grid_(makeHashGrid(positions_.empty() ? Vec3(0) : positions_.front(), radius, positions_.size()), threads) {
    grid_.build(positions_, there);
  }
  /// Calls visit(number) for those nearer than the radius, until it returns false.
  template <class Visit>
  void near(const Vec3& position, Visit&& visit) const {
    bool goesOn = true;
    grid_.forEachNearWhile(
        DVec3(position), radius_,
        [&](const SortedGrid::Placed& placed) { goesOn = goesOn && visit(std::size_t{placed.number}); },
        [&](std::size_t) { return goesOn; });
  }
  /// Calls visit(number, distance / radius) for all of them.
  template <class Visit>
  void forEachNear(const Vec3& position, Visit&& visit) const {
    grid_.forEachNear(DVec3(position), radius_, [&](const SortedGrid::Placed& placed) {
      visit(std::size_t{placed.number}, glm::distance(DVec3(placed.position), DVec3(position)) / radius_);
    });
  }
  bool hasNear(const Vec3& position) const {
    bool has = false;
    near(position, [&](std::size_t) {
      has = true;
      return false;
    });
    return has;
  }

 private:
  std::vector<Vec3> positions_;
  double radius_;
  SortedGrid grid_;
};

// Those of `of` by cells.
Cells cellsOf(std::span<const PointState> points, const PointBits& of, double radius, unsigned threads) {
  std::vector<Vec3> positions(points.size());
  std::vector<std::uint8_t> there(points.size());
  parallelFor(points.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      positions[i] = points[i].position;
      there[i] = of.test(i);
    }
  });
  return {std::move(positions), there, radius, threads};
}

// Those of `among` nearer than `radius` to one of `of`.
PointBits nearTo(std::span<const PointState> points, const PointBits& among, const PointBits& of, double radius,
                 unsigned threads) {
  if (!(radius > 0) || of.count() == 0) return PointBits(points.size());
  const Cells cells = cellsOf(points, of, radius, threads);
  return PointBits::where(points.size(), threads,
                          [&](std::size_t i) { return among.test(i) && cells.hasNear(points[i].position); });
}

}  // namespace

std::optional<std::size_t> nearestPoint(std::span<const PointState> points, const PointBits& among,
                                        const DVec3& position) {
  std::optional<std::size_t> nearest;
  double least2 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!among.test(i)) continue;
    const DVec3 apart = DVec3(points[i].position) - position;
    if (!(glm::dot(apart, apart) < least2)) continue;
    least2 = glm::dot(apart, apart);
    nearest = i;
  }
  return nearest;
}

PointBits pointsInBalls(std::span<const PointState> points, const PointBits& among, std::span<const Vec3> centres,
                        double radius, unsigned threads) {
  if (centres.empty() || !(radius > 0)) return PointBits(points.size());
  Vec3 low = centres.front(), high = low;
  for (const Vec3& centre : centres) {
    low = glm::min(low, centre);
    high = glm::max(high, centre);
  }
  const DVec3 from = DVec3(low) - radius, to = DVec3(high) + radius;
  const Cells cells({centres.begin(), centres.end()}, {}, radius, threads);
  return PointBits::where(points.size(), threads, [&](std::size_t i) {
    const DVec3 at(points[i].position);
    return among.test(i) && glm::all(glm::greaterThanEqual(at, from)) && glm::all(glm::lessThanEqual(at, to)) &&
           cells.hasNear(points[i].position);
  });
}

std::vector<std::uint8_t> weightsInBalls(std::span<const PointState> points, const PointBits& of,
                                         std::span<const Vec3> centres, double radius, std::uint32_t falloff,
                                         unsigned threads) {
  std::vector<std::uint8_t> weights(points.size());
  if (centres.empty() || !(radius > 0)) return weights;
  const Cells cells({centres.begin(), centres.end()}, {}, radius, threads);
  parallelFor(points.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!of.test(i)) continue;
      double nearest = 1;
      cells.forEachNear(points[i].position, [&](std::size_t, double r) { nearest = std::min(nearest, r); });
      const double share = nearest < 1 ? std::pow(1 - nearest * nearest, falloff) : 0;
      weights[i] = static_cast<std::uint8_t>(std::lround(share * PointLock::kWhole));
    }
  });
  return weights;
}

PointBits grown(std::span<const PointState> points, const PointBits& among, const PointBits& of, double radius,
                unsigned threads) {
  return of | nearTo(points, among - of, of, radius, threads);
}

PointBits shrunk(std::span<const PointState> points, const PointBits& among, const PointBits& of, double radius,
                 unsigned threads) {
  return of - nearTo(points, of, among - of, radius, threads);
}

// Breadth first, each wave of points by all threads.
PointBits connectedWith(std::span<const PointState> points, const PointBits& among, const PointBits& seeds,
                        double reach, unsigned threads) {
  PointBits found = seeds & among;
  std::vector<std::size_t> wave;
  found.set().forEach([&](std::uint64_t point) { wave.push_back(point); });
  if (wave.empty() || !(reach > 0)) return found;
  const Cells cells = cellsOf(points, among, reach, threads);
  while (!wave.empty()) {
    const ParallelRanges ranges(wave.size(), threads);
    std::vector<std::vector<std::size_t>> next(ranges.count());
    parallelParts(ranges.count(), [&](std::size_t range) {
      for (std::size_t k = ranges.begin(range); k < ranges.end(range); ++k)
        cells.near(points[wave[k]].position, [&](std::size_t point) {
          if (found.add(point)) next[range].push_back(point);
          return true;
        });
    });
    wave.clear();
    for (const auto& each : next) wave.insert(wave.end(), each.begin(), each.end());
  }
  return found;
}

std::vector<std::uint8_t> withRim(std::span<const PointState> points, const PointBits& among, const PointBits& of,
                                  double width, unsigned threads) {
  std::vector<std::uint8_t> weights(points.size());
  of.set().forEach([&](std::uint64_t point) { weights[point] = PointLock::kWhole; });
  if (!(width > 0) || of.count() == 0) return weights;
  const Cells cells = cellsOf(points, of, width, threads);
  const PointBits rim = among - of;
  parallelFor(points.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!rim.test(i)) continue;
      double nearest = 1;
      cells.forEachNear(points[i].position, [&](std::size_t, double r) { nearest = std::min(nearest, r); });
      const double share = 1 - nearest * nearest * (3 - 2 * nearest);
      weights[i] = static_cast<std::uint8_t>(std::lround(share * PointLock::kWhole));
    }
  });
  return weights;
}

std::vector<std::uint8_t> softened(std::span<const PointState> points, std::span<const std::uint8_t> weights,
                                   double radius, unsigned threads) {
  std::vector<std::uint8_t> next(weights.begin(), weights.end());
  if (!(radius > 0)) return next;
  const Cells cells = cellsOf(points, shownPoints(points, {}), radius, threads);
  parallelFor(points.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (points[i].gone || weights[i] == PointLock::kWhole) continue;
      double sum = weights[i], total = 1;
      cells.forEachNear(points[i].position, [&](std::size_t other, double r) {
        if (other == i) return;
        const double share = (1 - r * r) * (1 - r * r);
        sum += share * weights[other];
        total += share;
      });
      next[i] = static_cast<std::uint8_t>(std::lround(sum / total));
    }
  });
  return next;
}

std::vector<std::uint8_t> sharpened(std::span<const std::uint8_t> weights) {
  std::vector<std::uint8_t> next;
  for (const std::uint8_t weight : weights)
    next.push_back(static_cast<std::uint8_t>(std::clamp(2 * int{weight} - 127 - (weight < 128), 0, 255)));
  return next;
}

PointBits pointsLike(std::span<const PointState> points, const PointBits& among, const PointState& point,
                     const Likeness& likeness, unsigned threads) {
  const double least = likeness.normal_deg ? std::cos(glm::radians(*likeness.normal_deg)) : -1;
  const auto color = unpackedColor(point.color);
  return PointBits::where(points.size(), threads, [&](std::size_t i) {
    if (!among.test(i)) return false;
    const DVec3 a(points[i].normal), b(point.normal);
    const double length = glm::length(a) * glm::length(b);
    if (likeness.normal_deg && !(length > 0 && glm::dot(a, b) >= least * length)) return false;
    if (!likeness.color) return true;
    const auto other = unpackedColor(points[i].color);
    for (std::size_t k = 0; k < 3; ++k)
      if (std::abs(other[k] - color[k]) > *likeness.color) return false;
    return true;
  });
}

}  // namespace palpate
