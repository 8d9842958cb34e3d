#include "engine/cloud/spacing.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/eigen3.hpp"
#include "engine/cloud/places.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/parallel_collect.hpp"

namespace palpate {

namespace {

constexpr std::size_t kCoefficients = 6;
constexpr double kSingular = 1e-9;  // of a pivot, relative to the number of points: lengths are of the order of one

// Lower quartile of chi-squared with kNoisePoints - kCoefficients degrees of freedom, divided by that number
// (NIST/SEMATECH e-Handbook of Statistical Methods, section 1.3.6.7.4): a quarter of the variances is below this share
// of their mean.
constexpr double kLowerQuartile = 6.737 / 10;
static_assert(kNoisePoints - kCoefficients == 10);

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
  const PointTree tree(places.positions, threads);
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

std::optional<double> varianceOffQuadric(std::span<const DVec3> points) {
  if (points.size() <= kCoefficients) return std::nullopt;
  const auto count = static_cast<double>(points.size());
  DVec3 mean(0);
  for (const DVec3& p : points) mean += (p - points.front()) / count;
  mean += points.front();
  SymmetricMatrix3 covariance;
  for (const DVec3& p : points) covariance.addSquare(p - mean);
  const Eigen3 eigen = eigenSymmetric(covariance);
  const double size = std::sqrt(eigen.values[2] / count);
  if (!(size > 0) || !std::isfinite(size)) return std::nullopt;

  // The normal equations, with the heights as their last column, and the sum of the squared heights.
  std::array<std::array<double, kCoefficients + 1>, kCoefficients> rows{};
  double left = 0;
  for (const DVec3& p : points) {
    const DVec3 d = (p - mean) / size;
    const double x = glm::dot(d, eigen.vectors[2]), y = glm::dot(d, eigen.vectors[1]);
    const double z = glm::dot(d, eigen.vectors[0]);
    const std::array<double, kCoefficients + 1> terms{1, x, y, x * x, x * y, y * y, z};
    for (std::size_t i = 0; i < kCoefficients; ++i)
      for (std::size_t j = i; j <= kCoefficients; ++j) rows[i][j] += terms[i] * terms[j];
    left += z * z;
  }
  // Elimination in the upper triangle; each pivot removes its share of the squares.
  for (std::size_t i = 0; i < kCoefficients; ++i) {
    const double pivot = rows[i][i];
    if (!(pivot > kSingular * count)) return std::nullopt;
    for (std::size_t r = i + 1; r < kCoefficients; ++r)
      for (std::size_t j = r; j <= kCoefficients; ++j) rows[r][j] -= rows[i][r] / pivot * rows[i][j];
    left -= rows[i][kCoefficients] * rows[i][kCoefficients] / pivot;
  }
  return std::max(0.0, left) / (count - static_cast<double>(kCoefficients)) * size * size;
}

double noiseFrom(std::vector<double>& variances) {
  if (variances.empty()) return 0;
  const auto quartile = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 4);
  std::ranges::nth_element(variances, quartile);
  return std::sqrt(*quartile / kLowerQuartile);
}

double meanSpacing(const PointCloud& cloud, unsigned threads, std::size_t points) {
  return spacingRange(cloud, std::min(points, kLargestTree), threads).mean;
}
double roughSpacing(const PointCloud& cloud, unsigned threads) { return spacingRange(cloud, kRoughTree, threads).mean; }
SpacingRange spacingRange(const PointCloud& cloud, unsigned threads) {
  return spacingRange(cloud, kLargestTree, threads);
}

}  // namespace palpate
