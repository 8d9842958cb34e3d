#include "engine/cloud/gaussian_surface.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "engine/cloud/even_points.hpp"
#include "engine/cloud/gaussian_sheets.hpp"
#include "engine/core/check.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/core/parallel_radix_sort.hpp"

namespace palpate {

namespace {

constexpr float kShareOfUsual = 0.3f, kMinLevel = 0.2f, kMaxLevel = 1;  // densities
constexpr float kLongestStep = 0.7f, kLastStep = 0.05f;                 // usual radii
constexpr float kMaxToMiddle = 1, kMaxToFace = 2;  // in usual radii: limits of the first guess's distance from the seed
constexpr float kFacing = 0.3f;                    // minimum cosine between the sheet's normal and the level's
constexpr float kNearest = 0.75f;                  // usual radii between points
constexpr float kCompanyWithin = 2;                // usual radii
constexpr std::size_t kMinCompany = 4;             // of about twelve on an even surface
constexpr float kSmoothWithin = 2.25f;             // usual radii
constexpr float kClear = 1.5f;                     // in usual radii: free space required in front of a face

/// Limits of the path from a seed to the level. Thick scenes need longer paths, at a higher cost; in thin scenes seeds
/// without a face are inside.
struct Walk {
  float margin, farthest;  ///< usual radii
  float aside;             ///< in usual radii across the normal
  float mostDepth;  ///< in usual radii back from the level to the discs' centres, which are meaningless in thick haze
  int mostSteps;
};
constexpr Walk kShort{2, 2.5f, 0.5f, 2.5f, 6}, kLong{5, 7, 5, 1.5f, 16};
constexpr std::size_t kOneOfThick = 20;  // a scene is thick if one in this many seeds is too far from its face

float levelOf(std::span<const GaussianSheet> sheets, unsigned threads) {
  const auto densities = parallelCollect(
      sheets.size(), threads, [&](std::size_t i) { return sheets[i].exists(); },
      [&](std::size_t i) { return sheets[i].logDensity; });
  if (densities.empty()) return kMinLevel;
  const float median = parallelNth(densities, densities.size() / 2, threads);
  return std::clamp(kShareOfUsual * std::exp(median), kMinLevel, kMaxLevel);
}

struct SurfacePlace {
  Vec3 place{0}, normal{0}, color{0};  ///< usual radii; unit, or zero if there is none; 0 to 1
};

enum class Arrival { face, farther, none };

/// Walks to the face of the level on the outer side of the seed's sheet. `farther`: the face is beyond the walk.
Arrival findFace(const GaussianDensity& density, const Vec3& seed, const GaussianSheet& sheet, float level,
                 const Walk& walk, SurfacePlace& face) {
  const float logLevel = std::log(level);
  const float toMiddle = std::clamp(sheet.toMiddle, -kMaxToMiddle, kMaxToMiddle);
  const float above = sheet.logDensity + 0.5f * sheet.sharpness * toMiddle * toMiddle - logLevel;
  const float toFace = std::min(std::sqrt(2 * std::max(above, 0.0f) / sheet.sharpness), kMaxToFace);
  Vec3 place = seed + (toMiddle + toFace) * sheet.normal;
  for (int step = 0; step < walk.mostSteps; ++step) {
    const auto [value, gradient] = density.slopeAt(place);
    const float steepness = glm::length(gradient);
    if (!(value > 0) || !(steepness > 0)) return Arrival::none;
    // Newton step on the logarithm, which is nearly straight on a Gaussian's flank.
    const float way = std::clamp((std::log(value) - logLevel) * value / steepness, -kLongestStep, kLongestStep);
    const Vec3 outwards = -gradient / steepness;
    place += way * outwards;
    if (!(glm::distance(place, seed) < walk.farthest)) return Arrival::farther;
    if (std::abs(way) > kLastStep) continue;
    face = {place, outwards, Vec3(0)};
    return glm::dot(outwards, sheet.normal) > kFacing && density.densityAt(place + kClear * outwards) < level
               ? Arrival::face
               : Arrival::none;
  }
  return Arrival::farther;
}

/// Moves the face to the middle of the discs behind it and takes their colour.
SurfacePlace middleBehind(const GaussianDensity& density, SurfacePlace face, float mostDepth) {
  const auto [depth, color] = density.behind(face.place, face.normal);
  face.place -= std::clamp(depth, 0.0f, mostDepth) * face.normal;
  face.color = color;
  return isFinite(face.place) && isFinite(face.color) ? face : SurfacePlace{};
}

/// The region that the seeds of a cell can reach: outwards as far as the walk goes, and a little to the sides.
GaussianRegion regionOf(std::span<const GaussianSeed> seeds, std::span<const GaussianSheet> sheets, std::size_t first,
                        std::size_t last, const Walk& walk) {
  GaussianRegion region;
  for (std::size_t i = first; i < last; ++i) {
    if (!sheets[i].exists()) continue;
    region.widen(seeds[i].place + walk.margin * sheets[i].normal + walk.aside);
    region.widen(seeds[i].place + walk.margin * sheets[i].normal - walk.aside);
    region.widen(seeds[i].place + walk.aside);
    region.widen(seeds[i].place - walk.aside);
  }
  return region;
}

struct Projected {
  BareVector<SurfacePlace> places;     ///< one for each seed; without a normal if it found none
  BareVector<std::uint8_t> isFarther;  ///< for each seed
};

Projected projected(const SeedCells& cells, std::span<const GaussianSeed> seeds, std::span<const GaussianSheet> sheets,
                    float level, const Walk& walk, unsigned threads) {
  Projected made{BareVector<SurfacePlace>(seeds.size()), BareVector<std::uint8_t>(seeds.size())};
  parallelBlocks(cells.count(), kCellsAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    GaussianDensity density;
    GaussiansAround around(cells);
    for (std::size_t cell = begin; cell < end; ++cell) {
      const auto [first, last] = cells.seedsOf(cell);
      around.gather(cell, regionOf(seeds, sheets, first, last, walk), density);
      for (std::size_t i = first; i < last; ++i) {
        SurfacePlace face;
        const Arrival arrival =
            sheets[i].exists() ? findFace(density, seeds[i].place, sheets[i], level, walk, face) : Arrival::none;
        made.places[i] = arrival == Arrival::face ? middleBehind(density, face, walk.mostDepth) : SurfacePlace{};
        made.isFarther[i] = arrival == Arrival::farther;
      }
    }
  });
  return made;
}

/// The surface positions that the seeds reach; if many have farther to go than on thin sheets, these seeds walk again.
BareVector<SurfacePlace> surfacePlaces(const SeedCells& cells, std::span<const GaussianDisc> discs,
                                       std::span<const GaussianSeed> seeds, std::span<const GaussianSheet> sheets,
                                       float level, unsigned threads) {
  Projected made = projected(cells, seeds, sheets, level, kShort, threads);
  const auto isFarther = [&](std::size_t i) { return made.isFarther[i] != 0; };
  if (parallelCount(seeds.size(), threads, isFarther) * kOneOfThick > seeds.size()) {
    const auto farther = parallelCollect(seeds.size(), threads, isFarther, [&](std::size_t i) { return seeds[i]; });
    const auto theirs = parallelCollect(seeds.size(), threads, isFarther, [&](std::size_t i) { return sheets[i]; });
    const SeedCells wider(discs, farther, kLong.margin, threads);
    const Projected more = projected(wider, farther, theirs, level, kLong, threads);
    made.places.insert(made.places.end(), more.places.begin(), more.places.end());
  }
  return parallelCollect(
      made.places.size(), threads, [&](std::size_t i) { return made.places[i].normal != Vec3(0); },
      [&](std::size_t i) { return made.places[i]; });
}

/// Thins positions to even distances, removes isolated ones, and smooths the noise of single Gaussians in their
/// normals.
BareVector<SurfacePlace> evened(BareVector<SurfacePlace> places, unsigned threads) {
  BareVector<Vec3> points, normals;
  const auto divide = [&] {
    points = parallelMake(places.size(), threads, [&](std::size_t i) { return places[i].place; });
    normals = parallelMake(places.size(), threads, [&](std::size_t i) { return places[i].normal; });
  };
  const auto keepOnly = [&](const BareVector<std::uint32_t>& some) {
    places = parallelMake(some.size(), threads, [&](std::size_t i) { return places[some[i]]; });
    divide();
  };
  divide();
  keepOnly(evenlySpaced(points, normals, kNearest, threads));
  const BareVector<std::uint32_t> left = inCompany(points, normals, kCompanyWithin, kMinCompany, threads);
  if (!left.empty()) keepOnly(left);
  normals = smoothedNormals(points, normals, kSmoothWithin, threads);
  parallelFor(places.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) places[i].normal = normals[i];
  });
  return places;
}

/// Number of discs that lie beside the surface, farther from it than half its length.
std::size_t floatersAround(std::span<const SurfacePlace> places, std::span<const GaussianDisc> discs,
                           unsigned threads) {
  if (places.empty()) return 0;
  GaussianRegion box;
  for (const SurfacePlace& at : places) box.widen(at.place);
  const Vec3 sides = box.high - box.low;
  const float margin = 0.5f * std::max({sides.x, sides.y, sides.z});
  return parallelCount(discs.size(), threads, [&](std::size_t i) {
    const Vec3 beside = glm::max(box.low - discs[i].center, discs[i].center - box.high);
    return std::max({beside.x, beside.y, beside.z}) > margin;
  });
}

/// Points in model units, with a suitable origin.
PointCloud cloudOf(std::span<const SurfacePlace> places, const GaussianDiscs& frame, unsigned threads) {
  PointCloud cloud;
  if (places.empty()) return cloud;
  const auto modelPlace = [&](std::size_t i) { return frame.origin + frame.usualRadius * DVec3(places[i].place); };
  const auto join = [](const Bounds& a, const Bounds& b) {
    return Bounds{glm::min(a.min, b.min), glm::max(a.max, b.max)};
  };
  const Bounds first{modelPlace(0), modelPlace(0)};
  const auto boxOf = [&](std::size_t begin, std::size_t end) {
    Bounds box = first;
    for (std::size_t i = begin; i < end; ++i) box = join(box, {modelPlace(i), modelPlace(i)});
    return box;
  };
  cloud.origin = originFor(parallelReduce(places.size(), threads, first, boxOf, join));
  cloud.positions.resize(places.size()), cloud.normals.resize(places.size()), cloud.colors.resize(places.size());
  parallelFor(places.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::u8vec3 color(places[i].color * 255.0f + 0.5f);
      cloud.positions[i] = modelPlace(i) - cloud.origin;
      cloud.normals[i] = places[i].normal;
      cloud.colors[i] = {color.r, color.g, color.b, 255};
    }
  });
  return cloud;
}

}  // namespace

GaussianSurface surfaceOf(const GaussianScene& scene, unsigned threads) {
  PALPATE_CHECK(scene.logScales.size() == scene.size() && scene.rotations.size() == scene.size());
  PALPATE_CHECK(scene.opacityLogits.size() == scene.size() && scene.colorHarmonics.size() == scene.size());
  const GaussianDiscs made = discsOf(scene, threads);
  GaussianSurface surface;
  surface.faint = made.faint, surface.oversized = made.oversized, surface.outlying = made.outlying;
  if (made.discs.empty()) return surface;
  surface.spacing = made.usualRadius;
  const BareVector<GaussianSeed> seeds = seedsOver(made.discs, threads);
  const SeedCells cells(made.discs, seeds, kShort.margin, threads);
  BareVector<GaussianSheet> sheets = sheetsAt(cells, seeds, threads);
  const float level = levelOf(sheets, threads), logLevel = std::log(level);
  parallelFor(sheets.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (sheets[i].logDensity < logLevel) sheets[i] = {};
  });
  orientSheets(seeds, sheets, threads);
  surface.level = level;
  const BareVector<SurfacePlace> places =
      evened(surfacePlaces(cells, made.discs, seeds, sheets, level, threads), threads);
  surface.outlying += floatersAround(places, made.discs, threads);
  surface.cloud = cloudOf(places, made, threads);
  return surface;
}

}  // namespace palpate
