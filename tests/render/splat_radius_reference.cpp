#include "tests/render/splat_radius_reference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/cloud/point_tree.hpp"
#include "shaders/shared/splat_radius.h"

namespace palpate {

namespace {

constexpr std::size_t kDirections = 2 * shared::kSplatDirectionPairs;
constexpr double kTolerance = 1e-3;
using Closeness = std::array<double, kDirections>;  // reciprocal of the distance to the nearest border; 0: no border

Closeness closenessAbout(const PointCloud& cloud, std::size_t self, std::span<const std::uint32_t> others,
                         double ahead) {
  Closeness closeness{};
  const DVec3 normal(cloud.normals[self]);
  const Frame3 frame = frameAround(normal);
  for (const std::uint32_t other : others) {
    const DVec3 d = DVec3(cloud.positions[other]) - DVec3(cloud.positions[self]);
    const double squared = glm::dot(d, d);
    if (squared == 0) continue;
    if (glm::dot(DVec3(cloud.normals[other]), normal) <= static_cast<double>(shared::kSplatSameSheet)) continue;
    for (std::size_t k = 0; k < kDirections; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kDirections;
      const double along = glm::dot(d, std::cos(angle) * frame.u + std::sin(angle) * frame.v);
      const double least = ahead * std::sqrt(squared);
      if (along >= least) closeness[k] = std::max(closeness[k], 2 * along / squared);
    }
  }
  return closeness;
}

/// Borders closer than `open` (a reciprocal distance) bound the disc.
double radiusOf(const Closeness& closeness, double open, double alone) {
  double least = std::numeric_limits<double>::infinity();
  for (const double c : closeness)
    if (c >= open) least = std::min(least, c);
  return std::isfinite(least) ? static_cast<double>(shared::kSplatCover) / least : alone;
}

/// Whether the points nearer than `reach` are of a surface.
bool isOfSurface(const PointCloud& cloud, std::size_t self, std::span<const std::uint32_t> others, double reach) {
  const DVec3 normal(cloud.normals[self]);
  double around = 0, off = 0;
  for (const std::uint32_t other : others) {
    const DVec3 d = DVec3(cloud.positions[other]) - DVec3(cloud.positions[self]);
    const double distance = glm::length(d);
    if (distance == 0 || distance > reach) continue;
    if (glm::dot(DVec3(cloud.normals[other]), normal) <= static_cast<double>(shared::kSplatSameSheet)) continue;
    ++around;
    off += std::abs(glm::dot(d, normal)) > static_cast<double>(shared::kSplatOffPlane) * distance;
  }
  return around >= shared::kSplatFewestAround && off <= static_cast<double>(shared::kSplatOff) * around;
}

}  // namespace

std::vector<RadiusRange> referenceSplatRadii(const PointCloud& cloud, double spacing, double widest) {
  const PointTree tree(cloud.positions);
  std::vector<RadiusRange> radii;
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    found.clear();
    tree.near(DVec3(cloud.positions[i]), 2 * widest, found);
    RadiusRange range{std::numeric_limits<double>::infinity(), 0};
    // Both thresholds, within single precision.
    for (const double slack : {-1e-5, 0.0, 1e-5}) {
      const Closeness closeness = closenessAbout(cloud, i, found, static_cast<double>(shared::kSplatAhead) + slack);
      Closeness sorted = closeness;
      std::ranges::sort(sorted, std::greater());
      const double usual = sorted[shared::kSplatUsualRank - 1];
      const double open = std::max(usual / static_cast<double>(shared::kSplatOpen), 1 / widest);
      for (const double threshold : {1 - kTolerance, 1.0, 1 + kTolerance}) {
        const bool atBorder = sorted.back() < threshold * open;
        const double least = atBorder ? std::max(open, usual / static_cast<double>(shared::kSplatOpenAtBorder)) : open;
        const double radius = radiusOf(closeness, threshold * least, std::min(spacing, widest));
        range.least = std::min(range.least, (1 - kTolerance) * radius);
        range.most = std::max(range.most, (1 + kTolerance) * radius);
      }
    }
    // The search ends somewhere between twice the border and twice the widest one.
    const double alone = std::min(spacing, widest), cover = static_cast<double>(shared::kSplatCover);
    if (range.most > static_cast<double>(shared::kSplatLone) * spacing) {
      bool all = range.least > static_cast<double>(shared::kSplatLone) * spacing, any = false;
      for (int step = 0; step <= 20; ++step) {
        const bool isWide = isOfSurface(cloud, i, found, glm::mix(2 * range.least / cover, 2 * widest, 0.05 * step));
        all &= !isWide;
        any |= !isWide;
      }
      if (any) range.least = std::min(range.least, (1 - kTolerance) * alone);
      if (all) range.most = (1 + kTolerance) * alone;
    }
    radii.push_back(range);
  }
  return radii;
}

}  // namespace palpate
