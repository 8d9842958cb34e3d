#include "engine/cloud/analytic_shape.hpp"

#include <atomic>

#include "engine/cloud/counter_random.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {
namespace {

/// Point `i` of `count` of the lattice. The fractional part of i / golden ratio is the upper half of a wrapping
/// product, so it is exact for any i.
DVec2 latticePoint(std::uint64_t i, std::uint64_t count, std::uint64_t turn) {
  constexpr std::uint64_t kInverseGoldenRatio = 0x9E3779B97F4A7C15u;  // times 2^64
  const std::uint64_t fraction = i * kInverseGoldenRatio + turn;
  return {(static_cast<double>(i) + 0.5) / static_cast<double>(count), static_cast<double>(fraction >> 11) * 0x1p-53};
}

}  // namespace

double AnalyticShape::signedDistance(const DVec3& p) const {
  const SurfacePoint surface = closest(p);
  const DVec3 offset = p - surface.position;
  return std::copysign(glm::length(offset), glm::dot(offset, surface.normal));
}

PointCloud sampleShape(const AnalyticShape& shape, const SampleOptions& options) {
  PointCloud cloud;
  const DVec3 half(0.5 * shape.size());
  cloud.origin = originFor({shape.center() - half, shape.center() + half});
  cloud.positions.resize(options.count);
  cloud.normals.resize(options.count);
  if (options.count == 0) return cloud;
  const AreaMap map = shape.areaMap(options.threads);
  const std::uint64_t turn = randomBits(options.seed, 0);
  constexpr std::size_t kBetweenReports = 1 << 16;
  std::atomic<std::size_t> done = 0;
  parallelFor(options.count, options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (options.progress && (i - begin) % kBetweenReports == kBetweenReports - 1)
        options.progress(static_cast<double>(done += kBetweenReports) / static_cast<double>(options.count));
      const SurfacePoint point = map(latticePoint(i, options.count, turn));
      const DVec3 displacement = options.noise > 0 ? options.noise * randomNormal3(~options.seed, i) : DVec3(0);
      cloud.positions[i] = Vec3(point.position + displacement - cloud.origin);
      cloud.normals[i] = Vec3(point.normal);
    }
  });
  return cloud;
}

}  // namespace palpate
