#pragma once

#include <optional>

#include "engine/motion/frame_intake.hpp"
#include "engine/motion/fused_stream.hpp"
#include "engine/motion/pose_search_pass.hpp"
#include "engine/touch/frame_writer.hpp"

namespace palpate {

/// The map into which depth frames are fused on the GPU, as points of the live cloud; edits of those since the last
/// frame are kept. A frame without a camera pose is registered against the front half on a queue of its own, which
/// yields to questions; that half is not written before the frame is made. The effect of a frame on a point is spread
/// over the time until the next frame is due, as in FusedSource. If the stream is taken away, the map is unchanged.
class FusedFrames final : public FrameWriter {
 public:
  /// `frames.begin` is the initial live cloud; its points have the first ids. Throws as FusionPass.
  FusedFrames(Device& device, const FusedStream& frames, const LiveCloud& cloud);

  std::size_t size() const override { return cloud_.slots(); }
  /// Takes the next frame from the stream's player; a frame that cannot be registered or fused is reported, counted as
  /// lost, and skipped. If the time has gone back, restores the initial map first.
  MadeFrame make(double time_s, const LiveCloud::Half& incoming) override;
  void record(CommandList& list, const Front& front, const LiveCloud::Half& incoming,
              const Buffer& velocities) const override;
  bool turnsNormals() const override { return true; }
  double time_s() const override { return from_s_; }
  double extrapolationLimit_s() const override { return 0; }
  double comes_s() const override { return comes_s_; }
  bool isColored() const override { return colored_; }
  bool looksAtPoints() const override { return true; }
  std::uint64_t points() const override { return counts().points; }

  /// Number of frames fused, not registered, and lost.
  std::uint64_t fused() const { return intake_.fused(); }
  std::uint64_t unplaced() const { return intake_.unplaced(); }
  std::uint64_t lost() const { return intake_.lost(); }
  /// Counts of the last fused frame, once its list has run.
  FusionCounts counts() const { return pass_.counts(); }

 private:
  const PointCloud& begun() const { return *frames_.begin; }
  void startOver(const LiveCloud::Half& incoming);
  // False if the frame is skipped; the intake has the reason.
  bool puts(const DepthCamera& camera, const DepthFrame& frame);

  FusedStream frames_;
  std::optional<CameraPose> begunFrom_;  // camera pose of the last frame in the initial map
  const LiveCloud& cloud_;
  std::unique_ptr<Queue> queue_;  // used by make()
  FusionPass pass_;
  PoseSearchPass search_;
  FrameIntake intake_;
  bool isExact_;
  double from_s_ = 0, comes_s_ = 0;  // start and duration of its points' motion to their positions
  bool colored_;
};

}  // namespace palpate
