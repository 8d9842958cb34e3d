#pragma once

#include <optional>

#include "engine/motion/frame_intake.hpp"
#include "engine/motion/fused_stream.hpp"
#include "engine/motion/pose_search_pass.hpp"
#include "engine/touch/frame_writer.hpp"

namespace palpate {

/// The map that depth frames fuse into on the GPU, as points of the live cloud: what has been done to those since the
/// last frame stays. A frame that does not say where it was seen from is looked for in the front half, on a queue of
/// its own, which gives way to questions; nobody writes that half before the frame is made. What a frame does to a
/// point it does until the next one is due, as in FusedSource. A stream that is taken from it leaves the map as it is.
class FusedFrames final : public FrameWriter {
 public:
  /// `frames.begin` is the live cloud at first, whose points have the first ids. Throws as FusionPass.
  FusedFrames(Device& device, const FusedStream& frames, const LiveCloud& cloud);

  std::size_t size() const override { return cloud_.slots(); }
  /// The next frame that the stream's player hands out; one that cannot be placed or fused is said, counts as lost, and
  /// is left out. Where the time has gone back, the map that it begins with comes first.
  MadeFrame make(double time_s, const LiveCloud::Half& incoming) override;
  void record(CommandList& list, const Front& front, const LiveCloud::Half& incoming,
              const Buffer& velocities) const override;
  bool turnsNormals() const override { return true; }
  double time_s() const override { return from_s_; }
  double goOn_s() const override { return 0; }
  double comes_s() const override { return comes_s_; }
  bool isColored() const override { return colored_; }
  bool looksAtPoints() const override { return true; }

  /// Frames that were fused, and that could not be placed, or read.
  std::uint64_t fused() const { return intake_.fused(); }
  std::uint64_t unplaced() const { return intake_.unplaced(); }
  std::uint64_t lost() const { return intake_.lost(); }
  /// Of the frame that was fused last, once its list has run.
  FusionCounts counts() const { return pass_.counts(); }

 private:
  const PointCloud& begun() const { return *frames_.begin; }
  void startOver(const LiveCloud::Half& incoming);
  // False where the frame is left out, for whatever reason the intake has.
  bool puts(const DepthCamera& camera, const DepthFrame& frame);

  FusedStream frames_;
  std::optional<CameraPose> begunFrom_;  // from where the last frame of the map that it begins with was seen
  const LiveCloud& cloud_;
  std::unique_ptr<Queue> queue_;  // of make()
  FusionPass pass_;
  PoseSearchPass search_;
  FrameIntake intake_;
  bool isExact_;
  double from_s_ = 0, comes_s_ = 0;  // since when its points come to where they are, and for how long
  bool colored_;
};

}  // namespace palpate
