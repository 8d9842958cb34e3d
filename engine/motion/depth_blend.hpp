#pragma once

#include <vector>

#include "engine/core/cloud_frame.hpp"
#include "engine/core/depth_stream.hpp"

namespace palpate {

/// Makes one surface that moves of depth frames without correspondence: a frame's points begin where the surface was
/// seen last, and reach their own places when the next frame is due. So what is felt lags one frame behind, and does
/// not jump.
///
/// A point is looked for in the frame before, by projection (no pixel of one frame is one of the next, but the surface
/// is the same), or where a sensor sends points on the same ray. It begins in the very place, and with the normal, that
/// were seen there; of its velocity the part along the surface says nothing, as nobody knows how that slid. Where the
/// frame before saw nothing there, or another surface, the point stands in its place from the beginning.
class DepthBlend {
 public:
  /// The points do not depend on `threads` (0: one per core).
  explicit DepthBlend(unsigned threads = 1) : threads_(threads) {}

  /// The times of two frames, one after the other.
  struct Step {
    double between_s = 0;  ///< of the camera's time, from one to the other
    double since_s = 0;    ///< of the session's, since the points of the one before began to move
    double goOn_s = 0;     ///< of the session's, that those of this one have for their way
    double gone_s = 0;     ///< so much of that has passed
  };
  /// Whether that can be said of two frames: pictures, or points on the rays of one sensor.
  static bool canFollow(const DepthFrame& before, const DepthFrame& frame);
  /// What a frame saw, with its normals by pixel, or ray; zero where it has no point.
  struct Before {
    const DepthFrame& frame;
    const std::vector<Vec3>& normals;
  };
  /// `points` are those of `frame`, as DepthPoints makes them with their pixels(), and get velocities, turns and times
  /// to go. `before`: of the same camera, the frame that was given the last time.
  void follow(const DepthCamera& camera, const Before& before, const DepthFrame& frame, const DVec3& origin,
              const std::vector<std::uint32_t>& pixels, const Step& step, CloudFrame& points);
  /// There is no frame before: `points` stand where they are.
  void begin(CloudFrame& points);

 private:
  unsigned threads_;
  // Of a point, and of its normal.
  struct Way {
    Vec3 way{0}, turn{0};
  };
  std::vector<Way> left_;  // by the pixels of the frame before, as they were at its beginning; empty: none had any
  std::vector<Way> ways_;  // likewise, of this frame
  double waysGoOn_s_ = 0;
};

}  // namespace palpate
