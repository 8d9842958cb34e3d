#include "engine/motion/fused_playback.hpp"

#include <utility>

namespace palpate {

FusedPlayback::FusedPlayback(std::shared_ptr<DepthStream> stream, const PlayOptions& play, const FusionOptions& options,
                             std::optional<DepthFrame> first)
    : player_(std::move(stream), play, std::move(first)), fusion_(options) {}

bool FusedPlayback::hasNewer(double time_s, double /*than_s*/) { return player_.frameAt(time_s).serial != shown_; }

void FusedPlayback::makeFrame(double time_s, CloudFrame& frame) {
  const DepthPlayer::Played played = player_.frameAt(time_s);
  if (shown_ != played.serial) fusion_.fuse(player_.camera(), played.frame);
  shown_ = played.serial;
  fusion_.map().show(frame);
  frame.time_s = played.time_s;
}

}  // namespace palpate
