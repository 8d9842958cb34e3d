#pragma once

#include "engine/motion/cloud_source.hpp"
#include "engine/motion/depth_blend.hpp"
#include "engine/motion/depth_points.hpp"
#include "engine/motion/fused_stream.hpp"

namespace palpate {

/// The newest frame of a depth stream is the cloud: points in metres, in the world of the stream's poses, or in the
/// camera's axes where it has none (DepthPoints). No point of one frame is one of the next; their surface goes from the
/// one to the other until the next frame is due (DepthBlend). Where the stream is taken from it, the last frame stays;
/// where a live one falls silent for longer than that is true, there are no points until another frame comes.
class DepthSource final : public CloudSource {
 public:
  /// `origin`: of the cloud, metres.
  explicit DepthSource(std::shared_ptr<PlayedStream> stream, const DVec3& origin = DVec3(0));

  /// As many as the camera has pixels.
  std::size_t size() const override { return size_; }
  bool keepsPoints() const override { return false; }
  bool turnsNormals() const override { return true; }
  /// Throws Error where no frame of the stream can be read. A time of a recorded stream that is played exactly has the
  /// same points, whatever was asked for before.
  void makeFrame(double time_s, CloudFrame& frame) override;
  bool hasNewer(double time_s, double than_s) override;

 private:
  struct Made {
    std::uint64_t serial = 0;
    bool isAtRest = false;    // its points have come to where they were measured
    bool isOutdated = false;  // it is no longer there
    bool operator==(const Made&) const = default;
  };
  const DepthPlayer::Played& playedAt(double time_s);
  Made wanted(const DepthPlayer::Played& played, double time_s) const;
  /// The points of a frame, as it was measured.
  struct Measured {
    std::uint64_t number = 0;
    double time_s = 0;  ///< of the camera
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
  // What the player has said last: hasNewer() and makeFrame() for one time are of one frame.
  std::optional<DepthPlayer::Played> played_;
  double asked_s_ = 0;
  std::optional<Measured> now_, before_;  // of the frame that was played last, and the one before it
  std::optional<Made> made_;              // last
  double setOut_s_ = 0;                   // when its points did
};

}  // namespace palpate
