#include "engine/motion/fused_source.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/clock.hpp"

namespace palpate {

namespace {

constexpr double kHandOver_s = 0.003;    // from points on the host to points that are felt
constexpr float kFarthestWay_m = 0.02f;  // of a point from frame to frame: a larger one means a reused id

}  // namespace

FusedSource::FusedSource(FusedStream frames)
    : frames_(std::move(frames)),
      begunFrom_(frames_.stream->seenFrom),
      isExact_(frames_.stream->player && frames_.stream->player->isExact()),
      fusion_(frames_.options, frames_.icp, frames_.log) {
  begin();
}

void FusedSource::begin() {
  fusion_.begin(frames_.begin ? *frames_.begin : PointCloud(), begunFrom_);
  frames_.stream->seenFrom = begunFrom_;
  time_s_ = 0;
  shown_.clear();
  shownTime_ = {};
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
    lasts_s_ = played->lasts_s;
    ++changes_;
  }
  const DepthPlayer::Losses losses = stream.player->takeLosses();
  fusion_.countLost(losses.why, losses.frames);
}

bool FusedSource::hasNewer(double time_s, double /*than_s*/) {
  fuseDue(time_s);
  return changes_ != shownChanges_;
}

void FusedSource::makeFrame(double time_s, CloudFrame& frame) {
  const Stopwatch watch;
  fuseDue(time_s);
  // Points that start to move before they can be felt would jump by their latency.
  if (changes_ != shownChanges_)
    setOut(isExact_ ? time_s_ : std::max(time_s_, time_s + watch.elapsed_s() + kHandOver_s));
  shownChanges_ = changes_;
  fusion_.map().show(frame);
  frame.time_s = shownTime_.true_s - shownTime_.comes_s;
  frame.extrapolationLimit_s = 0;
  frame.comes_s = shownTime_.comes_s;
  frame.slides = false;
  if (frame.comes_s == 0) return;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const shared::SurfelWay& way = shown_[frame.idOf(i)].way;
    frame.velocities.push_back(way.velocity);
    frame.turns.push_back(way.turn);
  }
}

void FusedSource::setOut(double from_s) {
  const SurfelMap& map = fusion_.map();
  shared::FusionView view{};
  view.left = static_cast<float>(std::clamp(shownTime_.true_s - from_s, 0.0, shownTime_.comes_s));
  view.perSecond = static_cast<float>(lasts_s_ > 0 ? 1 / lasts_s_ : 0);
  shown_.resize(map.ids());
  for (std::size_t id = 0; id < map.ids(); ++id) {
    const Shown before = std::exchange(shown_[id], {});
    if (!map.holds(id)) continue;
    const shared::Surfel& now = map.surfel(id);
    shown_[id] = {.place = now.place, .normal = now.normal};
    if (before.normal == Vec3(0) || shared::measurementsOf(now.record) == 1) continue;
    if (!(glm::distance(now.place, before.place) <= kFarthestWay_m)) continue;
    shown_[id].way = shared::wayOn(view, before.place, before.normal, before.way, now.place, now.normal);
  }
  shownTime_ = {.true_s = from_s + lasts_s_, .comes_s = lasts_s_};
}

}  // namespace palpate
