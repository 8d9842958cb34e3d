// Surfaces with known ground truth: exact closest points and normals for measurements, and even samplings of any size
// for tests, benches and the built-in demo.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "engine/cloud/point_cloud.hpp"

namespace palpate {

struct SurfacePoint {
  DVec3 position{0};  ///< model units
  DVec3 normal{0};    ///< unit, outward
};

/// Maps the unit square onto a surface so that equal areas get equal shares. Valid while its shape lives.
using AreaMap = std::function<SurfacePoint(const DVec2&)>;

/// Safe to use from any number of threads.
class AnalyticShape {
 public:
  virtual ~AnalyticShape() = default;

  /// The point of the surface that is closest to `p`, with the surface's normal there. On an edge or a corner the
  /// normal points from it to `p`. If several points are equally close, returns one of them.
  virtual SurfacePoint closest(const DVec3& p) const = 0;

  /// Distance to the surface, positive outside (above, for the plane, which has no inside).
  double signedDistance(const DVec3& p) const;

  /// May take a second to set up for a form without closed formula; cheap to call afterwards.
  virtual AreaMap areaMap(unsigned threads) const = 0;

  /// Model units; as given to makeShape().
  DVec3 center() const { return center_; }
  double size() const { return size_; }

 protected:
  AnalyticShape(double size, const DVec3& center) : size_(size), center_(center) {}

 private:
  double size_;
  DVec3 center_;
};

/// `plane`: a square in z = center.z facing up. `cube`, `sphere`; `torus` around the z axis, radii 0.35 and 0.15 of the
/// size; `bumpy-sphere`: soft bumps of a few per cent; `sculpture`: a closed tube along a knot, smooth, fluted and
/// scaled in turn. `size` is the longest side of the bounding box, whose middle is `center`. Throws UsageError for
/// another name, listing these, and for a size that is not positive.
std::unique_ptr<AnalyticShape> makeShape(std::string_view name, double size = 100.0, const DVec3& center = DVec3(0));

std::span<const std::string_view> shapeNames();

struct SampleOptions {
  std::size_t count = 0;
  std::uint64_t seed = 1;
  double noise = 0;      ///< deviation of a Gaussian displacement along x, y and z, model units; normals stay exact
  unsigned threads = 0;  ///< 0: one per core; the result is the same
  std::function<void(double)> progress = {};  ///< called with the completed share, by any of these threads
};

/// Spreads `count` points evenly over the area of `shape`, with its normals: a rank-1 lattice of the golden ratio in
/// the unit square (Fibonacci lattice; Swinbank and Purser 2006 for the sphere), which stays even under stretching
/// along its axes, mapped by the shape's area map. `seed` shifts the lattice and seeds the noise. O(count). The cloud's
/// origin follows originFor() of the shape's box: zero unless the centre lies far away for its size.
PointCloud sampleShape(const AnalyticShape& shape, const SampleOptions& options);

}  // namespace palpate
