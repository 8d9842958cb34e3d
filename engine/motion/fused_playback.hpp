#pragma once

#include "engine/motion/cloud_source.hpp"
#include "engine/motion/depth_player.hpp"
#include "engine/motion/frame_fusion.hpp"

namespace palpate {

/// The map that the frames of a depth stream fuse into while it is played against the clock, or as they come from a camera:
/// what comes too late to be played is not fused. Points in metres, relative to the map's origin.
class FusedPlayback final : public CloudSource {
 public:
  /// `first`: as for DepthPlayer. Throws as FusionOptions::validate().
  FusedPlayback(std::shared_ptr<DepthStream> stream, const PlayOptions& play, const FusionOptions& options,
                std::optional<DepthFrame> first = {});

  std::size_t size() const override { return fusion_.map().options().capacity; }
  /// Throws Error where no frame of the stream can be read. One that cannot be placed or fused is counted, and the map
  /// stays as it was.
  void makeFrame(double time_s, CloudFrame& frame) override;
  bool hasNewer(double time_s, double than_s) override;

  /// Frames that have gone into the map.
  std::uint64_t fused() const { return fusion_.fused(); }
  DepthPlayer* player() override { return &player_; }
  std::optional<PlayCounts> playCounts() const override { return player_.counts(); }
  std::optional<PlayedView> playedView() const override { return player_.view(); }

 private:
  DepthPlayer player_;
  FrameFusion fusion_;
  std::optional<std::uint64_t> shown_;  // serial of the frame that came last
};

}  // namespace palpate
