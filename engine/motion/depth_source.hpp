#pragma once

#include "engine/motion/cloud_source.hpp"
#include "engine/motion/depth_player.hpp"

namespace palpate {

/// The newest frame of a depth stream is the cloud: points in metres, in the world of the stream's poses, or in the
/// camera's axes where it has none (makePoints()). No point of one frame is one of the next.
class DepthSource final : public CloudSource {
 public:
  /// `origin`: of the cloud, metres.
  DepthSource(std::shared_ptr<DepthStream> stream, const PlayOptions& options, const DVec3& origin = DVec3(0),
              std::optional<DepthFrame> first = {});

  /// As many as the camera has pixels.
  std::size_t size() const override { return std::size_t{player_.camera().width} * player_.camera().height; }
  bool keepsPoints() const override { return false; }
  /// Throws Error where no frame of the stream can be read. A time of a recorded stream that is played exactly has the
  /// same points, whatever was asked for before.
  void makeFrame(double time_s, CloudFrame& frame) override;
  bool hasNewer(double time_s, double than_s) override;

  DepthPlayer* player() override { return &player_; }
  std::optional<PlayCounts> playCounts() const override { return player_.counts(); }
  std::optional<PlayedView> playedView() const override { return player_.view(); }

 private:
  DepthPlayer player_;
  DVec3 origin_;
  std::optional<std::uint64_t> made_;  // serial of the frame that was made last
};

}  // namespace palpate
