// Options, inputs and results of fusion, shared by the maps on the host and on the GPU.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/core/depth_stream.hpp"
#include "shaders/shared/fusion.h"

namespace palpate {

/// Parameters of fusion. validate() names the field that is out of its bounds.
struct FusionOptions {
  std::size_t capacity = 5'000'000;  ///< maximum number of points of the map; 1 to 2^31 - 1
  /// Accepted depths, m; positive. Depths outside count as not measured.
  double nearest_m = 0.1, farthest_m = 10;
  /// Maximum number of frames that a point averages: a surface that moves by less than the gate is followed within that
  /// many. 1 to 10,000.
  double memory_frames = 50;
  /// Deviation of a measured depth, m: least + growth * (depth - from)^2; least is positive, the others not negative.
  double noiseLeast_m = 0.0012, noiseGrowth_per_m = 0.0019, noiseFrom_m = 0.4;
  unsigned threads = 0;  ///< 0: one per core; the result is the same

  /// Throws Error naming the field and its bounds.
  void validate() const;
};

/// Changes of the points by one frame, or by all.
struct FusionCounts {
  std::uint64_t points = 0;    ///< points of the map afterwards
  std::uint64_t matched = 0;   ///< points measured again
  std::uint64_t appended = 0;  ///< new points
  std::uint64_t removed = 0;   ///< points contradicted by free space, or never measured again
  std::uint64_t refused = 0;   ///< new points beyond the capacity

  bool operator==(const FusionCounts&) const = default;
};

/// Throws Error for a camera without pixels, with numbers that are not finite, or with focal lengths that are not
/// positive.
void requireCamera(const DepthCamera& camera);

/// A frame ready for fusion.
struct FrameImages {
  DepthCamera camera;
  std::uint64_t number = 0;
  std::vector<float> depths;          ///< m, row by row; 0 if not measured or not accepted
  std::vector<std::uint32_t> colors;  ///< RGBA8; may be empty
};

/// Reads a frame into memory that is reused. Throws Error if the number of depths or colours differs from the number of
/// pixels, for a depth that is negative or not finite (naming its pixel), and like requireCamera().
void readFrame(const DepthCamera& camera, const DepthFrame& frame, const FusionOptions& options, FrameImages& images);

/// Record of an existing point that no frame has measured: as if it had been measured from 1 m until stable. `color`:
/// RGBA8; 0: none.
shared::SurfelRecord givenRecord(const FusionOptions& options, std::uint32_t color);

shared::DepthSensor sensorOf(const DepthCamera& camera, const FusionOptions& options);

/// Throws Error for a pose that is not finite, or whose rotation is not of unit length.
void requirePose(const CameraPose& pose, std::uint64_t frame);

/// View of a frame from `pose` in a map with that origin in the world. Throws like requirePose().
shared::FusionView fusionView(const FrameImages& images, const CameraPose& pose, const DVec3& origin,
                              const FusionOptions& options);

/// Grey without a measured colour.
std::array<std::uint8_t, 3> colorOf(const shared::SurfelRecord& record);

/// Origin of a map whose first frame has that pose: whole metres, so that single precision suffices anywhere in the
/// world; zero within 16 m of the world's origin.
DVec3 mapOriginFor(const CameraPose& pose);

/// Surface seen by each pixel of a frame, in single precision, as on the GPU; into memory that is reused.
void findPixelSurfaces(const FrameImages& images, const FusionOptions& options,
                       std::vector<shared::PixelSurface>& surfaces);

/// Plane fitted to the depths around a pixel, in single or double precision. Depth 0: no plane.
template <class Real>
shared::PixelSurfaceOf<Real> pixelSurface(const FrameImages& images, const shared::DepthSensorOf<Real>& sensor,
                                          int column, int row) {
  const int width = static_cast<int>(images.camera.width), height = static_cast<int>(images.camera.height);
  const auto depthAt = [&](int x, int y) {
    return static_cast<Real>(images.depths[static_cast<std::size_t>(y * std::int64_t{width} + x)]);
  };
  const Real middle = depthAt(column, row);
  if (!(middle > 0)) return {};
  const int reach = shared::fitReach(sensor, middle);
  auto sums = shared::noPixels(Real(0));
  for (int y = std::max(row - reach, 0); y <= std::min(row + reach, height - 1); ++y)
    for (int x = std::max(column - reach, 0); x <= std::min(column + reach, width - 1); ++x)
      shared::addPixel(sums, sensor, middle, glm::vec<2, Real>(x - column, y - row), depthAt(x, y));
  return shared::surfaceOf(sums, sensor, glm::vec<2, Real>(column, row), middle);
}

}  // namespace palpate
