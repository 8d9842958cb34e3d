#include "engine/cloud/gaussian_surface.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "engine/cloud/even_points.hpp"
#include "engine/cloud/gaussian_sheets.hpp"
#include "engine/core/check.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

constexpr float kShareOfUsual = 0.3f, kLeastLevel = 0.2f, kMostLevel = 1;  // densities
constexpr float kLongestStep = 0.7f, kLastStep = 0.05f;                    // usual radii
constexpr float kMostToMiddle = 1, kMostToFace = 2;  // usual radii that the first guess may be off the seed
constexpr float kFacing = 0.3f;                      // cosine between the sheet's normal and the level's
constexpr float kNearest = 0.75f;                    // usual radii between points
constexpr float kCompanyWithin = 2;                  // usual radii
constexpr std::size_t kLeastCompany = 4;             // of some twelve on an even surface
constexpr float kSmoothWithin = 2.25f;               // usual radii
constexpr float kClear = 1.5f;                       // usual radii in front of a face where there is none

/// How far seeds go to the level. What is thick asks for more, and costs more; where hardly any of it is, it is inside.
struct Walk {
  float margin, farthest;  ///< usual radii
  float aside;             ///< usual radii across the normal
  float mostDepth;         ///< usual radii back from the level to the discs' middles, which in thick haze mean nothing
  int mostSteps;
};
constexpr Walk kShort{2, 2.5f, 0.5f, 2.5f, 6}, kLong{5, 7, 5, 1.5f, 16};
constexpr std::size_t kOneOfThick = 20;  // so many seeds that got nowhere make a scene thick

float levelOf(std::span<const GaussianSheet> sheets) {
  std::vector<float> densities;
  for (const GaussianSheet& sheet : sheets)
    if (sheet.exists()) densities.push_back(sheet.logDensity);
  if (densities.empty()) return kLeastLevel;
  const auto half = densities.begin() + static_cast<std::ptrdiff_t>(densities.size() / 2);
  std::ranges::nth_element(densities, half);
  return std::clamp(kShareOfUsual * std::exp(*half), kLeastLevel, kMostLevel);
}

struct SurfacePlace {
  Vec3 place{0}, normal{0}, color{0};  ///< usual radii; unit, or zero where there is none; 0 to 1
};

enum class Arrival { face, farther, none };

/// Walks to the face of the level that the seed's sheet has on its outer side. `farther`: it is not within the walk.
Arrival findFace(const GaussianDensity& density, const Vec3& seed, const GaussianSheet& sheet, float level,
                 const Walk& walk, SurfacePlace& face) {
  const float logLevel = std::log(level);
  const float toMiddle = std::clamp(sheet.toMiddle, -kMostToMiddle, kMostToMiddle);
  const float above = sheet.logDensity + 0.5f * sheet.sharpness * toMiddle * toMiddle - logLevel;
  const float toFace = std::min(std::sqrt(2 * std::max(above, 0.0f) / sheet.sharpness), kMostToFace);
  Vec3 place = seed + (toMiddle + toFace) * sheet.normal;
  for (int step = 0; step < walk.mostSteps; ++step) {
    const auto [value, gradient] = density.slopeAt(place);
    const float steepness = glm::length(gradient);
    if (!(value > 0) || !(steepness > 0)) return Arrival::none;
    // Of the logarithm, which over a Gaussian's flank is nearly straight.
    const float way = std::clamp((std::log(value) - logLevel) * value / steepness, -kLongestStep, kLongestStep);
    const Vec3 outwards = -gradient / steepness;
    place += way * outwards;
    if (!(glm::distance(place, seed) < walk.farthest)) return Arrival::farther;
    if (std::abs(way) > kLastStep) continue;
    face = {place, outwards, Vec3(0)};
    return glm::dot(outwards, sheet.normal) > kFacing && density.slopeAt(place + kClear * outwards).density < level
               ? Arrival::face
               : Arrival::none;
  }
  return Arrival::farther;
}

/// The face as a place of the surface: at the middle of the discs behind it, in their colour.
SurfacePlace middleBehind(const GaussianDensity& density, SurfacePlace face, float mostDepth) {
  const auto [depth, color] = density.behind(face.place, face.normal);
  face.place -= std::clamp(depth, 0.0f, mostDepth) * face.normal;
  face.color = color;
  return isFinite(face.place) && isFinite(face.color) ? face : SurfacePlace{};
}

/// Where the seeds of a cell may get to: outwards as far as the walk goes, and a little to the sides.
SeedCells::Region regionOf(std::span<const GaussianSeed> seeds, std::span<const GaussianSheet> sheets,
                           std::size_t first, std::size_t last, const Walk& walk) {
  SeedCells::Region region;
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
  std::vector<SurfacePlace> places;     ///< one for each seed; without a normal where there is none
  std::vector<std::uint8_t> isFarther;  ///< for each seed
};

Projected projected(const SeedCells& cells, std::span<const GaussianSeed> seeds, std::span<const GaussianSheet> sheets,
                    float level, const Walk& walk, unsigned threads) {
  Projected made{std::vector<SurfacePlace>(seeds.size()), std::vector<std::uint8_t>(seeds.size(), 0)};
  parallelFor(cells.count(), threads, [&](std::size_t begin, std::size_t end) {
    GaussianDensity density;
    for (std::size_t cell = begin; cell < end; ++cell) {
      const auto [first, last] = cells.seedsOf(cell);
      cells.gather(cell, regionOf(seeds, sheets, first, last, walk), density);
      for (std::size_t i = first; i < last; ++i) {
        if (!sheets[i].exists()) continue;
        SurfacePlace face;
        const Arrival arrival = findFace(density, seeds[i].place, sheets[i], level, walk, face);
        if (arrival == Arrival::face) made.places[i] = middleBehind(density, face, walk.mostDepth);
        made.isFarther[i] = arrival == Arrival::farther;
      }
    }
  });
  return made;
}

/// All places that the seeds get to; where many have farther to go than those of thin sheets, these once more.
std::vector<SurfacePlace> surfacePlaces(const SeedCells& cells, std::span<const GaussianDisc> discs,
                                        std::span<const GaussianSeed> seeds, std::span<const GaussianSheet> sheets,
                                        float level, unsigned threads) {
  Projected made = projected(cells, seeds, sheets, level, kShort, threads);
  std::vector<GaussianSeed> farther;
  std::vector<GaussianSheet> theirSheets;
  for (std::size_t i = 0; i < seeds.size(); ++i)
    if (made.isFarther[i]) farther.push_back(seeds[i]), theirSheets.push_back(sheets[i]);
  if (farther.size() * kOneOfThick > seeds.size()) {
    const SeedCells wider(discs, farther, kLong.margin, threads);
    const Projected more = projected(wider, farther, theirSheets, level, kLong, threads);
    made.places.insert(made.places.end(), more.places.begin(), more.places.end());
  }
  std::erase_if(made.places, [](const SurfacePlace& place) { return place.normal == Vec3(0); });
  return std::move(made.places);
}

std::vector<SurfacePlace> chosen(const std::vector<SurfacePlace>& places, const std::vector<std::uint32_t>& numbers) {
  std::vector<SurfacePlace> some;
  for (const std::uint32_t i : numbers) some.push_back(places[i]);
  return some;
}

/// Places at even distances, without those that are alone, and without the noise of single Gaussians in their normals.
std::vector<SurfacePlace> evened(std::vector<SurfacePlace> places, unsigned threads) {
  std::vector<Vec3> points, normals;
  const auto divide = [&] {
    points.clear(), normals.clear();
    for (const SurfacePlace& place : places) points.push_back(place.place), normals.push_back(place.normal);
  };
  divide();
  places = chosen(places, evenlySpaced(points, normals, kNearest, threads));
  divide();
  const std::vector<std::uint32_t> left = inCompany(points, normals, kCompanyWithin, kLeastCompany, threads);
  if (!left.empty()) places = chosen(places, left);
  divide();
  normals = smoothedNormals(points, normals, kSmoothWithin, threads);
  for (std::size_t i = 0; i < places.size(); ++i) places[i].normal = normals[i];
  return places;
}

/// Points in model units, with the origin that they ask for.
PointCloud cloudOf(const std::vector<SurfacePlace>& places, const GaussianDiscs& frame) {
  PointCloud cloud;
  if (places.empty()) return cloud;
  const auto modelPlace = [&](const SurfacePlace& p) { return frame.origin + frame.usualRadius * DVec3(p.place); };
  Bounds box{modelPlace(places.front()), modelPlace(places.front())};
  for (const SurfacePlace& p : places) box = {glm::min(box.min, modelPlace(p)), glm::max(box.max, modelPlace(p))};
  cloud.origin = originFor(box);
  for (const SurfacePlace& p : places) {
    const glm::u8vec3 color(p.color * 255.0f + 0.5f);
    cloud.positions.emplace_back(modelPlace(p) - cloud.origin);
    cloud.normals.push_back(p.normal);
    cloud.colors.push_back({color.r, color.g, color.b, 255});
  }
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
  const std::vector<GaussianSeed> seeds = seedsOver(made.discs, threads);
  const SeedCells cells(made.discs, seeds, kShort.margin, threads);
  std::vector<GaussianSheet> sheets = sheetsAt(cells, seeds, threads);
  const float level = levelOf(sheets);
  for (GaussianSheet& sheet : sheets)
    if (sheet.logDensity < std::log(level)) sheet = {};
  orientSheets(seeds, sheets, threads);
  surface.level = level;
  surface.cloud = cloudOf(evened(surfacePlaces(cells, made.discs, seeds, sheets, level, threads), threads), made);
  return surface;
}

}  // namespace palpate
