#include "engine/motion/depth_source.hpp"

#include <algorithm>
#include <limits>
#include <thread>
#include <utility>

#include "engine/core/clock.hpp"

namespace palpate {

namespace {

// Frames further apart are not blended: the motion in between is unknown.
constexpr double kLongestGap_s = 0.2;
// From points on the host to points that can be felt: enough to copy and index 300,000 of them.
constexpr double kHandOver_s = 0.003;
// Without a new frame for this time, points that have arrived are made once more, so that they are drawn and saved at
// rest.
constexpr double kSettled_s = 0.1;

// Frames are made beside a servo thread that may lack real-time priority: most cores stay free.
unsigned frameThreads() { return std::clamp(std::thread::hardware_concurrency() / 4, 1u, 4u); }

}  // namespace

DepthSource::DepthSource(std::shared_ptr<PlayedStream> stream, const DVec3& origin)
    : stream_(std::move(stream)),
      origin_(origin),
      isExact_(stream_->player->isExact()),
      points_(frameThreads()),
      blend_(frameThreads()) {
  const DepthCamera& camera = stream_->player->camera();
  size_ = std::size_t{camera.width} * camera.height;
}

const DepthPlayer::Played& DepthSource::playedAt(double time_s) {
  if (!played_ || isExact_ || asked_s_ != time_s) played_.emplace(stream_->player->frameAt(time_s));
  asked_s_ = time_s;
  return *played_;
}

DepthSource::Made DepthSource::wanted(const DepthPlayer::Played& played, double time_s) const {
  const bool isNew = !made_ || made_->serial != played.serial;
  const double setOut_s = isExact_ ? played.time_s : setOut_s_;
  return {.serial = played.serial,
          .isAtRest = (isExact_ || !isNew) && time_s >= setOut_s + played.lasts_s + kSettled_s,
          .isOutdated = stream_->player->isOutdated(time_s)};
}

void DepthSource::makeFrame(double time_s, CloudFrame& frame) {
  if (!stream_->player) return;
  const Stopwatch watch;
  const DepthPlayer::Played& played = playedAt(time_s);
  made_ = wanted(played, time_s);
  if (made_->isOutdated) {
    frame = {.time_s = time_s};
    return;
  }
  measure(played);
  frame = now_->points;
  frame.time_s = played.time_s;
  if (made_->isAtRest)
    blend_.begin(frame);
  else
    blend(played, time_s, time_s + watch.elapsed_us() * 1e-6 + kHandOver_s, frame);
}

// A frame is measured once, however often its points are blended; usually the previous one is known as well.
void DepthSource::measure(const DepthPlayer::Played& played) {
  const auto isOf = [](const std::optional<Measured>& measured, const DepthFrame& frame) {
    return measured && measured->number == frame.number && measured->time_s == frame.time_s;
  };
  if (!isOf(now_, played.frame)) {
    std::swap(now_, before_);
    if (!isOf(now_, played.frame)) measure(played.frame, now_);
  }
  if (played.before && !isOf(before_, *played.before)) measure(*played.before, before_);
}

void DepthSource::measure(const DepthFrame& frame, std::optional<Measured>& measured) {
  if (!measured) measured = Measured{};
  measured->number = frame.number;
  measured->time_s = frame.time_s;
  points_.make(stream_->player->camera(), frame, origin_, measured->points);
  measured->pixels = points_.pixels();
  points_.normalsByPixel(measured->points, size_, measured->normals);
}

void DepthSource::blend(const DepthPlayer::Played& played, double time_s, double ready_s, CloudFrame& frame) {
  const double between_s = played.before ? played.frame.time_s - played.before->time_s : 0;
  const bool follows = between_s > 0 && between_s <= kLongestGap_s && played.lasts_s > 0 &&
                       DepthBlend::canFollow(*played.before, played.frame);
  if (!follows) {
    setOut_s_ = played.time_s;
    return blend_.begin(frame);
  }
  DepthBlend::Step step{.between_s = between_s, .lasts_s = played.lasts_s};
  if (isExact_) {
    // A recording says when the next frame is due, so no displacement remains from the previous frame. Points are made
    // at their current positions.
    step.since_s = std::numeric_limits<double>::infinity();
    step.gone_s = time_s - played.time_s;
    frame.time_s = time_s;
  } else {
    // The surface starts to move once it can be felt, so that it does not jump by its latency.
    frame.time_s = std::max(played.time_s, ready_s);
    step.since_s = frame.time_s - setOut_s_;
    setOut_s_ = frame.time_s;
  }
  blend_.follow(stream_->player->camera(), {.frame = *played.before, .normals = before_->normals}, played.frame,
                origin_, now_->pixels, step, frame);
}

bool DepthSource::hasNewer(double time_s, double /*than_s*/) {
  return stream_->player && wanted(playedAt(time_s), time_s) != made_;
}

}  // namespace palpate
