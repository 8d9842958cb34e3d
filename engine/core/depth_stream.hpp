// What depth cameras and scanners see, frame by frame, live or recorded: the seam between whoever reads it and whoever
// makes points of it.
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
  /// The place that is seen by a pixel at a depth along z, in that depth's unit.
  DVec3 placeAt(double column, double row, double depth) const {
    return {(column - cx) / fx * depth, (row - cy) / fy * depth, depth};
  }
  /// The pixel that sees a place in front of the camera: column and row.
  DVec2 pixelOf(const DVec3& place) const { return {fx * place.x / place.z + cx, fy * place.y / place.z + cy}; }
};

/// Where a camera stands in the world, metres.
struct CameraPose {
  DQuat turn{1, 0, 0, 0};  ///< unit; from the camera's axes to the world's
  DVec3 centre{0};

  DVec3 toWorld(const DVec3& place) const { return turn * place + centre; }
  DVec3 toCamera(const DVec3& place) const { return glm::conjugate(turn) * (place - centre); }
};

/// The same, for the many places of a frame.
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

/// What a sensor saw that sends points, and no picture of depth.
struct SensedPoints {
  std::vector<DVec3> places;  ///< in the world of the stream, metres
  std::vector<Vec3> normals;  ///< unit, of each
  /// Of a sensor whose rays lie in rows: how many a row has, and the ray of each place, row by row, ascending. None:
  /// nothing is known of rays.
  std::uint32_t rowLength = 0;
  std::vector<std::uint32_t> rays;
};

/// What a depth camera saw at one time.
struct DepthFrame {
  double time_s = 0;           ///< since the stream began
  std::uint64_t number = 0;    ///< of all frames that the stream has had, from 0; a frame that was lost has one, too
  std::vector<float> depth_m;  ///< along z, row by row; 0 where none was measured
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< of the same pixels; empty where there are none
  std::optional<CameraPose> pose;                   ///< where it is known
  std::optional<SensedPoints> points;               ///< in place of depths; colours are theirs, then
};

/// Frames in the order of their times. For one thread at a time.
class DepthStream {
 public:
  virtual ~DepthStream() = default;

  /// Of a sensor that sends points: as wide as a frame may have some, and one pixel high.
  virtual const DepthCamera& camera() const = 0;
  /// The next frame, into memory that is used again; waits where it is still to come. False after the last one, and
  /// once stop() was called. Throws Error, with file and place, for a frame that cannot be read: it counts as lost, and
  /// the next call goes on with the one behind it.
  virtual bool next(DepthFrame& frame) = 0;
  /// Ends a next() that waits, and all that come. From any thread.
  virtual void stop() noexcept {}
  /// Whether all of it is there already, so that it can begin again; otherwise it comes as it is seen.
  virtual bool isRecorded() const = 0;
  /// Live: so long its last frame is taken for what is there while no other comes; then nothing is.
  virtual double staysTrue_s() const { return std::numeric_limits<double>::infinity(); }
  /// Recorded: from the first frame again.
  virtual void rewind() = 0;
  /// Recorded: passes over frames, unread, so that the next one is the last of those up to that time, or stays the next
  /// one; how many there were.
  virtual std::uint64_t skipTo(double) { return 0; }
  /// Recorded: frames in all, lost ones included, and the time of the last one.
  virtual std::uint64_t frames() const { return 0; }
  virtual double duration_s() const { return 0; }
};

}  // namespace palpate
