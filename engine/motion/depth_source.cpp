#include "engine/motion/depth_source.hpp"

#include <utility>

#include "engine/motion/depth_points.hpp"

namespace palpate {

DepthSource::DepthSource(std::shared_ptr<PlayedStream> stream, const DVec3& origin)
    : stream_(std::move(stream)), origin_(origin) {
  const DepthCamera& camera = stream_->player->camera();
  size_ = std::size_t{camera.width} * camera.height;
}

void DepthSource::makeFrame(double time_s, CloudFrame& frame) {
  if (!stream_->player) return;
  const DepthPlayer::Played played = stream_->player->frameAt(time_s);
  makePoints(stream_->player->camera(), played.frame, origin_, frame);
  frame.time_s = played.time_s;
  made_ = played.serial;
}

bool DepthSource::hasNewer(double time_s, double /*than_s*/) {
  return stream_->player && stream_->player->frameAt(time_s).serial != made_;
}

}  // namespace palpate
