#pragma once

#include <vector>

#include "engine/core/cloud_frame.hpp"
#include "engine/core/depth_stream.hpp"

namespace palpate {

/// Makes one moving surface of depth frames without correspondence: the points of a frame begin where the surface was
/// last seen, and reach their own positions when the next frame is due. The felt surface lags one frame behind, and
/// does not jump.
///
/// A point is looked up in the previous frame by projection (pixels do not correspond, but the surface is the same), or
/// on the same ray if a sensor sends points. It begins at the position and with the normal seen there. The tangential
/// part of its velocity means nothing, since sliding cannot be observed. Where the previous frame saw no surface or
/// another one, the point starts at its own position.
class DepthBlend {
 public:
  /// The points do not depend on `threads` (0: one per core).
  explicit DepthBlend(unsigned threads = 1) : threads_(threads) {}

  /// Times of two consecutive frames.
  struct Step {
    double between_s = 0;  ///< camera time between the two frames
    double since_s = 0;    ///< session time since the points of the previous frame began to move
    double lasts_s = 0;    ///< session time in which the points of this frame reach their positions
    double gone_s = 0;     ///< part of lasts_s that has passed
  };
  /// Whether correspondence is possible: both are depth images, or points on the rays of one sensor.
  static bool canFollow(const DepthFrame& before, const DepthFrame& frame);
  /// A frame with its normals by pixel or ray; zero where it has no point.
  struct Before {
    const DepthFrame& frame;
    const std::vector<Vec3>& normals;
  };
  /// `points` are those of `frame`, made by DepthPoints with their pixels(); they receive velocities, rotations and a
  /// time limit. `before`: the frame of the same camera that was passed last.
  void follow(const DepthCamera& camera, const Before& before, const DepthFrame& frame, const DVec3& origin,
              const std::vector<std::uint32_t>& pixels, const Step& step, CloudFrame& points);
  /// Without a previous frame: `points` do not move.
  void begin(CloudFrame& points);

 private:
  unsigned threads_;
  // Displacement of a point, and change of its normal.
  struct Way {
    Vec3 way{0}, turn{0};
  };
  std::vector<Way> left_;  // at the start of the previous frame, by its pixels; empty: no point moved
  std::vector<Way> ways_;  // likewise, for this frame
  double waysLast_s_ = 0;
};

}  // namespace palpate
