#pragma once

#include <vector>

#include "engine/core/cloud_frame.hpp"
#include "engine/core/depth_stream.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/motion/depth_points.hpp"
#include "engine/motion/fused_stream.hpp"

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

/// The newest frame of a depth stream is the cloud: points in metres, in the world of the stream's poses, or in the
/// camera's axes if it has none (DepthPoints). Points of two frames do not correspond; their surface moves from one
/// frame to the next until the latter is due (DepthBlend). If another source takes over the stream, the last frame
/// stays. If a live stream is silent for longer than its frames are valid, the cloud is empty until the next frame.
class DepthSource final : public CloudSource {
 public:
  /// `origin`: origin of the cloud, metres.
  explicit DepthSource(std::shared_ptr<PlayedStream> stream, const DVec3& origin = DVec3(0));

  /// Number of pixels of the camera.
  std::size_t size() const override { return size_; }
  bool keepsPoints() const override { return false; }
  bool turnsNormals() const override { return true; }
  /// Throws Error if no frame of the stream can be read. In exact play of a recorded stream the same time has the same
  /// points, independent of earlier calls.
  void makeFrame(double time_s, CloudFrame& frame) override;
  bool hasNewer(double time_s, double than_s) override;

 private:
  struct Made {
    std::uint64_t serial = 0;
    bool isAtRest = false;    // its points have reached their measured positions
    bool isOutdated = false;  // it is no longer valid
    bool operator==(const Made&) const = default;
  };
  const DepthPlayer::Played& playedAt(double time_s);
  Made wanted(const DepthPlayer::Played& played, double time_s) const;
  /// Points of a frame as measured.
  struct Measured {
    std::uint64_t number = 0;
    double time_s = 0;  ///< camera time
    CloudFrame points;
    std::vector<std::uint32_t> pixels;
    std::vector<Vec3> normals;  ///< by pixel; zero where there is no point
  };
  void measure(const DepthFrame& frame, std::optional<Measured>& measured);
  void measure(const DepthPlayer::Played& played);
  void blend(const DepthPlayer::Played& played, double time_s, double ready_s, CloudFrame& frame);

  std::shared_ptr<PlayedStream> stream_;
  std::size_t size_;
  DVec3 origin_;
  bool isExact_;
  DepthPoints points_;
  DepthBlend blend_;
  // Last reply of the player: hasNewer() and makeFrame() for one time use one frame.
  std::optional<DepthPlayer::Played> played_;
  double asked_s_ = 0;
  std::optional<Measured> now_, before_;  // frame that was played last, and the one before it
  std::optional<Made> made_;              // last frame made
  double setOut_s_ = 0;                   // when its points began to move
};

}  // namespace palpate
