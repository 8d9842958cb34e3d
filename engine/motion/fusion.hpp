// What a fusion of depth frames is told, what it sees, and what it says: shared by the map on the host and the one on
// the GPU.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/core/depth_stream.hpp"
#include "shaders/shared/fusion.h"

namespace palpate {

/// By which rules frames are fused. validate() says which number is out of its bounds.
struct FusionOptions {
  std::size_t capacity = 5'000'000;  ///< points of the map at most; 1 to 2^31 - 1
  /// Depths that are believed, m; positive. What lies nearer or farther counts as not measured.
  double nearest_m = 0.1, farthest_m = 10;
  /// Frames that a point remembers at most: a surface that moves less than the gate is followed in so many. 1 to
  /// 10,000.
  double memory_frames = 50;
  /// Deviation of a measured depth, m: least + growth * (depth - from)^2; least is positive, the others not negative.
  double noiseLeast_m = 0.0012, noiseGrowth_per_m = 0.0019, noiseFrom_m = 0.4;
  unsigned threads = 0;  ///< 0: one per core; the result is the same

  /// Throws Error naming the field and its bounds.
  void validate() const;
};

/// What became of the points in one frame, or in all of them.
struct FusionCounts {
  std::uint64_t points = 0;    ///< of the map, afterwards
  std::uint64_t matched = 0;   ///< that were measured again
  std::uint64_t appended = 0;  ///< that are new
  std::uint64_t removed = 0;   ///< that free space has contradicted, or that were never measured again
  std::uint64_t refused = 0;   ///< that found no room

  bool operator==(const FusionCounts&) const = default;
};

/// Throws Error where a camera is none: without pixels, or with numbers that are not finite, or focal lengths that are
/// not positive.
void requireCamera(const DepthCamera& camera);

/// A frame as it is fused.
struct FrameImages {
  DepthCamera camera;
  std::uint64_t number = 0;
  std::vector<float> depths;          ///< m, row by row; 0 where none was measured, or none that is believed
  std::vector<std::uint32_t> colors;  ///< RGBA8; empty where there are none
};

/// Reads a frame into memory that is used again. Throws Error where it has not as many depths as its camera has pixels,
/// or colours, and for a depth that is negative or no number, with its pixel; for a camera as requireCamera().
void readFrame(const DepthCamera& camera, const DepthFrame& frame, const FusionOptions& options, FrameImages& images);

/// What is known of a point that no frame has seen, but that is there: as if it had been measured often enough from 1
/// m. `color`: RGBA8; 0 where it has none.
shared::SurfelRecord givenRecord(const FusionOptions& options, std::uint32_t color);

shared::DepthSensor sensorOf(const DepthCamera& camera, const FusionOptions& options);

/// Throws Error for a pose that is no number, or whose turn is not of unit length.
void requirePose(const CameraPose& pose, std::uint64_t frame);

/// What a frame sees from `pose` in a map with that origin in the world. Throws as requirePose().
shared::FusionView fusionView(const FrameImages& images, const CameraPose& pose, const DVec3& origin,
                              const FusionOptions& options);

/// Grey where none was seen.
std::array<std::uint8_t, 3> colorOf(const shared::SurfelRecord& record);

/// The origin of a map whose first frame was seen from there: whole metres, so that coordinates in single precision
/// resolve the room about it, wherever in the world it is; zero within 16 m of it.
DVec3 mapOriginFor(const CameraPose& pose);

}  // namespace palpate
