#include "engine/cloud/analytic_shape.hpp"

#include <array>
#include <atomic>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/shapes.hpp"
#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"
#include "engine/core/unknown_name.hpp"

namespace palpate {
namespace {

struct Entry {
  std::string_view name;
  std::unique_ptr<AnalyticShape> (*make)(double size, const DVec3& center);
};
constexpr std::array<Entry, 6> kShapes{{{"plane", makePlane},
                                        {"cube", makeCube},
                                        {"sphere", makeSphere},
                                        {"torus", makeTorus},
                                        {"bumpy-sphere", makeBumpySphere},
                                        {"sculpture", makeSculpture}}};

constexpr auto kShapeNames = [] {
  std::array<std::string_view, kShapes.size()> names;
  for (std::size_t k = 0; k < names.size(); ++k) names[k] = kShapes[k].name;
  return names;
}();

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

std::span<const std::string_view> shapeNames() { return kShapeNames; }

std::unique_ptr<AnalyticShape> makeShape(std::string_view name, double size, const DVec3& center) {
  if (!(size > 0) || !std::isfinite(size)) throw UsageError("a shape of size {}; expected a number above 0", size);
  if (!isFinite(center)) throw UsageError("a shape's centre must be three finite numbers");
  for (const Entry& entry : kShapes)
    if (entry.name == name) return entry.make(size, center);
  throw UsageError("{}", unknownName("shape", name, kShapeNames));
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
