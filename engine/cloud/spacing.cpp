#include "engine/cloud/spacing.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/noise.hpp"
#include "engine/cloud/places.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/parallel_collect.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMaxProbes = 2000;
// Range of neighbour counts whose discs are averaged. On a lattice neighbours come in rings, so that the disc to any
// single one is up to a tenth too large or too small; over this range the spacing is accurate to two per cent on
// square, hexagonal, Fibonacci and random samplings alike.
constexpr std::size_t kFirst = 8, kLast = 32;
// A k-d tree over more points than this would take longer than a second, or than a twentieth of one.
constexpr std::size_t kLargestTree = 1'000'000, kRoughTree = 50'000;

/// Keeps each position with the same probability, decided by its coordinates so that coincident points stay or go
/// together.
BareVector<Vec3> thinned(const std::vector<Vec3>& points, double keep, unsigned threads) {
  const auto stays = [&](std::size_t i) {
    const Vec3& p = points[i];
    const auto bits = [](float v) { return std::uint64_t{std::bit_cast<std::uint32_t>(v + 0.0f)}; };  // -0 is 0
    return randomUnit(bits(p.x) << 32 | bits(p.y), bits(p.z)) < keep;
  };
  return parallelCollect(points.size(), threads, stays, [&](std::size_t i) { return points[i]; });
}

/// Area per position around one of them. The disc to its k-th neighbour holds on average k areas if points are random
/// and, since half of the outermost point belongs to it, k + 1/2 on a lattice; 1/4 serves both.
double areaPerPlace(std::span<const double> squaredDistances) {
  const std::size_t neighbours = squaredDistances.size() - 1;
  const std::size_t first = std::min(kFirst, neighbours);
  double sum = 0;
  for (std::size_t k = first; k <= neighbours; ++k)
    sum += std::numbers::pi * squaredDistances[k] / (static_cast<double>(k) + 0.25);
  return sum / static_cast<double>(neighbours - first + 1);
}

/// Whether the disc to the first and to the last neighbour hold about the same area per position, as on a surface;
/// those of an outlier are all at about the same distance.
bool areOnSurface(std::span<const double> squaredDistances) {
  constexpr double kAlike = 2;
  const std::size_t last = squaredDistances.size() - 1;
  const double share = (kFirst + 0.25) / (static_cast<double>(last) + 0.25);
  return last > kFirst && squaredDistances[kFirst] <= kAlike * share * squaredDistances[last];
}

/// Estimates from the nearest neighbours of a position.
struct Around {
  double areaPerPlace;  ///< squared model units
  bool isOnSurface;
  std::optional<double> varianceOverArea;  ///< about their surface; empty if unknown
};

Around lookAround(const PointTree& tree, const std::vector<Vec3>& places, const Vec3& place) {
  std::array<std::uint32_t, kLast + 1> indices;
  std::array<double, kLast + 1> squaredDistances;
  const std::size_t found = tree.nearest(place, indices, squaredDistances);  // the first is the position itself
  const std::span<const double> known(squaredDistances.data(), found);
  Around around{.areaPerPlace = areaPerPlace(known), .isOnSurface = areOnSurface(known), .varianceOverArea = {}};
  if (found < kNoisePoints) return around;
  std::array<DVec3, kNoisePoints> offsets;
  for (std::size_t k = 0; k < kNoisePoints; ++k) offsets[k] = DVec3(places[indices[k]]) - DVec3(place);
  const std::optional<double> variance = varianceOffQuadric(offsets);
  if (variance && around.areaPerPlace > 0) around.varianceOverArea = *variance / around.areaPerPlace;
  return around;
}

/// The area per position up to which nine tenths of the surface lie: a sparse part may have few points and much area.
/// Parts of more than kFarthest times the `usual` area float about: no hand could feel them. 0 if no probe is on a
/// surface.
double wideAreaOf(const std::vector<Around>& probes, double usual) {
  constexpr double kShare = 0.9, kFarthest = 12 * 12;
  std::vector<double> areas;
  for (const Around& probe : probes)
    if (probe.isOnSurface && probe.areaPerPlace <= kFarthest * usual) areas.push_back(probe.areaPerPlace);
  std::ranges::sort(areas);
  const double all = std::accumulate(areas.begin(), areas.end(), 0.0);
  double sum = 0;
  for (const double area : areas)
    if ((sum += area) >= kShare * all) return area;
  return 0;
}

SpacingRange spacingRange(const PointCloud& cloud, std::size_t largestTree, unsigned threads) {
  const double keep = std::min(1.0, static_cast<double>(largestTree) / static_cast<double>(cloud.size()));
  const Places places = keep < 1 ? distinctPlaces(thinned(cloud.positions, keep, threads), threads)
                                 : distinctPlaces(cloud.positions, threads);
  if (places.positions.size() < 2) return {};
  const PointTree tree(places.positions);
  std::vector<Around> probes(std::min(kMaxProbes, places.positions.size()));
  parallelFor(probes.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      probes[n] = lookAround(tree, places.positions, places.positions[n * places.positions.size() / probes.size()]);
  });
  std::vector<double> areas, variances;
  for (const Around& probe : probes) {
    areas.push_back(probe.areaPerPlace);
    if (probe.varianceOverArea) variances.push_back(*probe.varianceOverArea);
  }
  std::ranges::sort(areas);
  // Keeping a share of the points multiplies the area per position by 1 / keep.
  const auto spacing = [&](double area) { return std::sqrt(area * keep); };
  return {.mean = spacing(areas[areas.size() / 2]),
          .wide = spacing(
              std::max(areas[areas.size() - 1 - areas.size() / 50], wideAreaOf(probes, areas[areas.size() / 2]))),
          .noise = noiseFrom(variances) / std::sqrt(keep)};
}

}  // namespace

double meanSpacing(const PointCloud& cloud, unsigned threads, std::size_t points) {
  return spacingRange(cloud, std::min(points, kLargestTree), threads).mean;
}
double roughSpacing(const PointCloud& cloud, unsigned threads) { return spacingRange(cloud, kRoughTree, threads).mean; }
SpacingRange spacingRange(const PointCloud& cloud, unsigned threads) {
  return spacingRange(cloud, kLargestTree, threads);
}

}  // namespace palpate
