// Frames of depth cameras and scanners, live or recorded: the seam between their readers and the code that makes points
// of them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/ext/quaternion_common.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// A pinhole camera without distortion that looks along z, with x to the right and y down. The middle of the first
/// pixel is at (0, 0).
struct DepthCamera {
  std::uint32_t width = 0, height = 0;    ///< pixels
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels

  bool operator==(const DepthCamera&) const = default;
  /// The position seen by a pixel at a depth along z, in that depth's unit.
  DVec3 placeAt(double column, double row, double depth) const {
    return {(column - cx) / fx * depth, (row - cy) / fy * depth, depth};
  }
  /// The pixel, as column and row, that sees a position in front of the camera.
  DVec2 pixelOf(const DVec3& place) const { return {fx * place.x / place.z + cx, fy * place.y / place.z + cy}; }
};

/// Pose of a camera in the world, metres.
struct CameraPose {
  DQuat turn{1, 0, 0, 0};  ///< unit; from the camera's axes to the world's
  DVec3 centre{0};

  DVec3 toWorld(const DVec3& place) const { return turn * place + centre; }
  DVec3 toCamera(const DVec3& place) const { return glm::conjugate(turn) * (place - centre); }
};

/// The same with precomputed axes, for the many positions of a frame.
class CameraAxes {
 public:
  explicit CameraAxes(const CameraPose& pose)
      : right_(pose.turn * DVec3(1, 0, 0)),
        down_(pose.turn * DVec3(0, 1, 0)),
        ahead_(pose.turn * DVec3(0, 0, 1)),
        centre_(pose.centre) {}

  DVec3 turned(const DVec3& direction) const {
    return direction.x * right_ + direction.y * down_ + direction.z * ahead_;
  }
  DVec3 toWorld(const DVec3& place) const { return turned(place) + centre_; }
  DVec3 toCamera(const DVec3& place) const {
    const DVec3 way = place - centre_;
    return {glm::dot(way, right_), glm::dot(way, down_), glm::dot(way, ahead_)};
  }

 private:
  DVec3 right_, down_, ahead_, centre_;
};

/// Data of a sensor that sends points instead of a depth image.
struct SensedPoints {
  std::vector<DVec3> places;  ///< in the world of the stream, metres
  std::vector<Vec3> normals;  ///< unit, one for each position
  /// For a sensor whose rays lie in rows: the rays per row, and the ray of each position, row by row, ascending. Empty:
  /// the rays are unknown.
  std::uint32_t rowLength = 0;
  std::vector<std::uint32_t> rays;
};

/// Data of a depth camera at one time.
struct DepthFrame {
  double time_s = 0;                                ///< since the stream began
  std::uint64_t number = 0;                         ///< counts all frames of the stream from 0, lost frames included
  std::vector<float> depth_m;                       ///< along z, row by row; 0 where no depth was measured
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< of the same pixels; empty if there are no colours
  std::optional<CameraPose> pose;                   ///< if known
  std::optional<SensedPoints> points;               ///< instead of depths; colours then belong to these points
};

/// Frames in the order of their times. Used by one thread at a time.
class DepthStream {
 public:
  virtual ~DepthStream() = default;

  /// For a sensor that sends points: the width is the maximum number of points in a frame, the height one pixel.
  virtual const DepthCamera& camera() const = 0;
  /// Reads the next frame into reused memory; waits for it if it has not arrived. False after the last frame and once
  /// stop() was called. Throws Error, with file and position, for a frame that cannot be read: it counts as lost, and
  /// the next call continues with the frame after it.
  virtual bool next(DepthFrame& frame) = 0;
  /// Ends a waiting next() and all later ones. From any thread.
  virtual void stop() noexcept {}
  /// Whether the stream is complete, so that it can be rewound; otherwise it is live.
  virtual bool isRecorded() const = 0;
  /// Live: the time for which its last frame is valid while no other arrives; afterwards there are no points.
  virtual double staysTrue_s() const { return std::numeric_limits<double>::infinity(); }
  /// Recorded: restarts with the first frame.
  virtual void rewind() = 0;
  /// Recorded: skips frames without reading them, so that the next frame is the last one up to that time, or remains
  /// the next one. Returns the number of skipped frames.
  virtual std::uint64_t skipTo(double) { return 0; }
  /// Recorded: number of frames, lost ones included, and the time of the last one.
  virtual std::uint64_t frames() const { return 0; }
  virtual double duration_s() const { return 0; }
};

}  // namespace palpate
