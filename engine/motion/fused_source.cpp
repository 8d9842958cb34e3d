#include "engine/motion/fused_source.hpp"

#include <utility>

namespace palpate {

FusedSource::FusedSource(FusedStream frames)
    : frames_(std::move(frames)),
      begunFrom_(frames_.stream->seenFrom),
      fusion_(frames_.options, frames_.icp, frames_.log) {
  begin();
}

void FusedSource::begin() {
  fusion_.begin(frames_.begin ? *frames_.begin : PointCloud(), begunFrom_);
  frames_.stream->seenFrom = begunFrom_;
  time_s_ = 0;
  ++changes_;
}

void FusedSource::fuseDue(double time_s) {
  PlayedStream& stream = *frames_.stream;
  if (!stream.player) return;
  if (stream.player->rewindFor(time_s)) begin();
  while (const auto played = stream.player->nextDue(time_s)) {
    const FrameOutcome& outcome = fusion_.fuse(stream.player->camera(), played->frame);
    if (outcome.fate != FrameFate::fused) {
      stream.player->leaveOut(outcome.why);
      continue;
    }
    stream.seenFrom = outcome.pose;
    time_s_ = played->time_s;
    ++changes_;
  }
  const DepthPlayer::Losses losses = stream.player->takeLosses();
  fusion_.countLost(losses.why, losses.frames);
}

bool FusedSource::hasNewer(double time_s, double /*than_s*/) {
  fuseDue(time_s);
  return changes_ != shown_;
}

void FusedSource::makeFrame(double time_s, CloudFrame& frame) {
  fuseDue(time_s);
  fusion_.map().show(frame);
  frame.time_s = time_s_;
  shown_ = changes_;
}

}  // namespace palpate
