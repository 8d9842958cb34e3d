#include "engine/cloud/gaussian_sheets.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/cloud/orientation.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/core/parallel_radix_sort.hpp"

namespace palpate {

namespace {

constexpr float kMinDensity = 0.05f;  // peak density of the faintest disc
constexpr std::size_t kMaxPlaces = 200'000;
constexpr std::size_t kNeighbours = 10;
constexpr float kApart = 2.5;  // in cell sides: distance between sheets that are not connected
constexpr std::size_t kFewestGaussians = 8;
constexpr std::uint32_t kNobody = NeighbourGraph::kNobody;

/// The direction of the largest eigenvalue, by repeated squaring (power iteration); zero for a matrix without one, or
/// that is not finite. Needs far fewer operations than all eigenvectors, and is as accurate if that direction is
/// unique.
DVec3 steepestOf(const SymmetricMatrix3& a) {
  constexpr int kSquarings = 6;
  // Makes all eigenvalues positive, so that the largest one also has the largest magnitude.
  const double shift =
      std::abs(a.xx) + std::abs(a.yy) + std::abs(a.zz) + 2 * (std::abs(a.xy) + std::abs(a.xz) + std::abs(a.yz));
  if (!(shift > 0)) return DVec3(0);
  // Scales to trace 1, so that the largest eigenvalue is at least a third, and 3^-64 at the end.
  const double scale = 1 / (a.xx + a.yy + a.zz + 3 * shift);
  SymmetricMatrix3 power{scale * (a.xx + shift), scale * (a.yy + shift), scale * (a.zz + shift),
                         scale * a.xy,           scale * a.xz,           scale * a.yz};
  for (int k = 0; k < kSquarings; ++k) {
    const auto [xx, yy, zz, xy, xz, yz] = power;
    power = {.xx = xx * xx + xy * xy + xz * xz,
             .yy = xy * xy + yy * yy + yz * yz,
             .zz = xz * xz + yz * yz + zz * zz,
             .xy = xx * xy + xy * yy + xz * yz,
             .xz = xx * xz + xy * yz + xz * zz,
             .yz = xy * xz + yy * yz + yz * zz};
  }
  const std::array<DVec3, 3> rows{DVec3(power.xx, power.xy, power.xz), DVec3(power.xy, power.yy, power.yz),
                                  DVec3(power.xz, power.yz, power.zz)};
  const DVec3& longest = *std::ranges::max_element(rows, {}, [](const DVec3& row) { return glm::dot(row, row); });
  const double length = glm::length(longest);
  return length > 0 ? longest / length : DVec3(0);
}

GaussianSheet sheetAt(const GaussianDensity& density, const Vec3& place) {
  const GaussianDensity::Curvature curvature = density.curvatureAt(place);
  if (!(curvature.density > kMinDensity)) return {};
  const SymmetricMatrix3& a = curvature.downwards;
  const DVec3 n = steepestOf(a);
  const double sharpness = a.xx * n.x * n.x + a.yy * n.y * n.y + a.zz * n.z * n.z +
                           2 * (a.xy * n.x * n.y + a.xz * n.x * n.z + a.yz * n.y * n.z);
  if (!(sharpness > 0)) return {};
  return {.normal = Vec3(n),
          .logDensity = std::log(curvature.density),
          .toMiddle = static_cast<float>(glm::dot(n, DVec3(curvature.logGradient)) / sharpness),
          .sharpness = static_cast<float>(sharpness)};
}

/// The densest seed of each cell of a grid, and its neighbours.
struct SheetPlaces {
  float side = 0;                     ///< of a cell
  BareVector<std::uint32_t> placeOf;  ///< for each seed; kNobody if it has no sheet
  BareVector<Vec3> points, normals;
  NeighbourGraph graph;
};

void findNeighbours(SheetPlaces& places, unsigned threads) {
  const PointTree tree(places.points, threads);
  places.graph.degree = kNeighbours;
  places.graph.neighbours.assign(places.points.size() * kNeighbours, kNobody);
  parallelFor(places.points.size(), threads, [&](std::size_t begin, std::size_t end) {
    std::array<std::uint32_t, kNeighbours + 1> near;
    std::array<double, kNeighbours + 1> squared;
    const double most = std::pow(static_cast<double>(kApart * places.side), 2);
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t found = tree.nearest(places.points[i], near, squared);
      std::size_t slot = 0;
      for (std::size_t k = 0; k < found; ++k)
        if (near[k] != i && squared[k] < most && slot < kNeighbours) places.graph.of(i)[slot++] = near[k];
    }
  });
}

SheetPlaces placesOf(std::span<const GaussianSeed> seeds, std::span<const GaussianSheet> sheets, unsigned threads) {
  constexpr int kFinest = 2;
  const auto existing = parallelCollect(
      seeds.size(), threads, [&](std::size_t i) { return sheets[i].exists(); },
      [](std::size_t i) { return static_cast<std::uint32_t>(i); });
  const auto cellsOf = [&](int level) {
    return parallelRuns(existing.size(), threads, [&](std::size_t k) {
      return seeds[existing[k]].voxel >> (3 * level) == seeds[existing[k - 1]].voxel >> (3 * level);
    });
  };
  int level = kFinest;
  auto begins = cellsOf(level);
  while (begins.size() - 1 > kMaxPlaces) begins = cellsOf(++level);

  SheetPlaces places;
  places.side = kSeedVoxel * static_cast<float>(1 << level);
  places.placeOf = parallelMake(seeds.size(), threads, [](std::size_t) { return kNobody; });
  const auto densest = parallelMake(begins.size() - 1, threads, [&](std::size_t place) {
    const std::span cell(&existing[begins[place]], begins[place + 1] - begins[place]);
    for (const std::uint32_t seed : cell) places.placeOf[seed] = static_cast<std::uint32_t>(place);
    return *std::ranges::max_element(cell, {}, [&](std::uint32_t seed) { return sheets[seed].logDensity; });
  });
  places.points = parallelMake(densest.size(), threads, [&](std::size_t k) { return seeds[densest[k]].place; });
  places.normals = parallelMake(densest.size(), threads, [&](std::size_t k) { return sheets[densest[k]].normal; });
  if (!places.points.empty()) findNeighbours(places, threads);
  return places;
}

/// For each position the first one of its connected group.
std::vector<std::uint32_t> groupsOf(const SheetPlaces& places) {
  std::vector<std::uint32_t> parent(places.points.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (std::uint32_t i = 0; i < parent.size(); ++i)
    for (const std::uint32_t j : places.graph.of(i)) {
      if (j == kNobody) continue;
      const std::uint32_t a = root(i), b = root(j);
      parent[std::max(a, b)] = std::min(a, b);
    }
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = root(i);
  return parent;
}

/// Number of Gaussians of each group, at its first position. A Gaussian with seeds in several groups may count more
/// than once.
std::vector<std::atomic<std::uint32_t>> countGaussians(std::span<const GaussianSeed> seeds, const SheetPlaces& places,
                                                       const std::vector<std::uint32_t>& groups, unsigned threads) {
  struct Member {
    std::uint32_t disc, group;
    bool operator==(const Member&) const = default;
  };
  auto members = parallelCollect(
      seeds.size(), threads, [&](std::size_t i) { return places.placeOf[i] != kNobody; },
      [&](std::size_t i) {
        return Member{seeds[i].disc, groups[places.placeOf[i]]};
      });
  parallelRadixSort(members, 32, threads, [](const Member& member) { return member.disc; });
  std::vector<std::atomic<std::uint32_t>> counts(groups.size());
  parallelFor(members.size(), threads, [&](std::size_t begin, std::size_t end) {
    std::uint32_t own = 0;  // of the current group: nearly all consecutive members are of the same one
    for (std::size_t k = begin; k < end; ++k) {
      own += k == 0 || members[k] != members[k - 1];
      if (k + 1 < end && members[k + 1].group == members[k].group) continue;
      counts[members[k].group] += std::exchange(own, 0);
    }
  });
  return counts;
}

std::size_t dropSmallGroups(std::span<const GaussianSeed> seeds, std::span<GaussianSheet> sheets,
                            const SheetPlaces& places, unsigned threads) {
  const std::vector<std::uint32_t> groups = groupsOf(places);
  const auto counts = countGaussians(seeds, places, groups, threads);
  const std::size_t largest =
      counts.empty() ? 0 : std::ranges::max_element(counts, {}, [](const auto& count) { return count.load(); })->load();
  const std::size_t fewest = std::min(kFewestGaussians, largest);
  const auto isSmall = [&](std::size_t i) {
    return places.placeOf[i] != kNobody && counts[groups[places.placeOf[i]]] < fewest;
  };
  parallelFor(seeds.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (isSmall(i)) sheets[i] = {};
  });
  return parallelCount(seeds.size(), threads, isSmall);
}

/// Whether a seed's normal points to the other side than the position around it that most likely belongs to the same
/// sheet, as if both lay on a circle (orientNormals()).
bool looksAway(const SheetPlaces& places, std::uint32_t own, const Vec3& point, const Vec3& normal) {
  float best = std::numeric_limits<float>::infinity();
  bool away = false;
  const auto ask = [&](std::uint32_t place) {
    const Vec3 way = places.points[place] - point;
    // Distance alone can exceed the best cost, so most candidates need no square root.
    if (glm::dot(way, way) >= best * best * places.side * places.side) return;
    const float distance = glm::length(way);
    const Vec3 along = distance > 0 ? way / distance : Vec3(0);
    const float off = glm::dot(normal, along), otherOff = glm::dot(places.normals[place], along);
    const float agreement = glm::dot(normal, places.normals[place]) - 2 * off * otherOff;
    const float cost = distance / places.side + 1 - std::abs(agreement) + std::abs(off) + std::abs(otherOff);
    if (cost >= best) return;
    best = cost;
    away = agreement < 0;
  };
  ask(own);
  for (const std::uint32_t place : places.graph.of(own))
    if (place != kNobody) ask(place);
  return away;
}

}  // namespace

BareVector<GaussianSheet> sheetsAt(const SeedCells& cells, std::span<const GaussianSeed> seeds, unsigned threads) {
  BareVector<GaussianSheet> sheets(seeds.size());
  parallelBlocks(cells.count(), kCellsAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    GaussianDensity density;
    GaussiansAround around(cells);
    for (std::size_t cell = begin; cell < end; ++cell) {
      const auto [first, last] = cells.seedsOf(cell);
      GaussianRegion region;
      for (std::size_t i = first; i < last; ++i) region.widen(seeds[i].place);
      around.gather(cell, region, density);
      for (std::size_t i = first; i < last; ++i) sheets[i] = sheetAt(density, seeds[i].place);
    }
  });
  return sheets;
}

std::size_t orientSheets(std::span<const GaussianSeed> seeds, std::span<GaussianSheet> sheets, unsigned threads) {
  SheetPlaces places = placesOf(seeds, sheets, threads);
  const std::size_t dropped = dropSmallGroups(seeds, sheets, places, threads);
  orientNormals(places.points, places.normals, places.graph, threads);
  parallelFor(seeds.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (sheets[i].exists() && looksAway(places, places.placeOf[i], seeds[i].place, sheets[i].normal))
        sheets[i].turn();
  });
  return dropped;
}

}  // namespace palpate
