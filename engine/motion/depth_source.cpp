#include "engine/motion/depth_source.hpp"

#include <utility>

#include "engine/motion/depth_points.hpp"

namespace palpate {

DepthSource::DepthSource(std::shared_ptr<DepthStream> stream, const PlayOptions& options, const DVec3& origin,
                         std::optional<DepthFrame> first)
    : player_(std::move(stream), options, std::move(first)), origin_(origin) {}

void DepthSource::makeFrame(double time_s, CloudFrame& frame) {
  const DepthPlayer::Played played = player_.frameAt(time_s);
  makePoints(player_.camera(), played.frame, origin_, frame);
  frame.time_s = played.time_s;
  made_ = played.serial;
}

bool DepthSource::hasNewer(double time_s, double /*than_s*/) { return player_.frameAt(time_s).serial != made_; }

}  // namespace palpate
