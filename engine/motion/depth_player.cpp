#include "engine/motion/depth_player.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr double kSilent_s = 1;
constexpr double kRounding_s = 1e-9;  // a frame that is due at a tick is not held back to the next one by rounding
constexpr double kUsualRate_Hz = 30;  // where one frame is all there is

/// From the first frame to that of the next pass: as long as frames are apart in the middle.
double periodOf(const DepthStream& stream) {
  if (stream.frames() < 2 || !(stream.duration_s() > 0)) return 1 / kUsualRate_Hz;
  return stream.duration_s() * static_cast<double>(stream.frames()) / static_cast<double>(stream.frames() - 1);
}

}  // namespace

DepthPlayer::DepthPlayer(std::shared_ptr<DepthStream> stream, const PlayOptions& options,
                         std::optional<DepthFrame> first)
    : options_(options),
      ahead_(std::move(stream), options.loop, std::move(first)),
      period_s_(periodOf(ahead_.stream())),
      time_(options.speed) {}

// Where in a recording a time of the session is.
DepthPlayer::Place DepthPlayer::placeAt(double time_s) const {
  const double place_s = time_.placeAt(time_s) + kRounding_s;
  if (!options_.loop || place_s < 0) return {.pass = 0, .time_s = place_s};
  const double pass = std::floor(place_s / period_s_);
  return {.pass = static_cast<std::uint64_t>(pass), .time_s = place_s - pass * period_s_};
}

void DepthPlayer::takeNext(const Place& place) {
  ahead_.take(frame_, false);
  current_ = place;
  currentSince_s_ = time_.timeOf(static_cast<double>(place.pass) * period_s_ + (place.isFirst ? 0 : place.time_s));
}

void DepthPlayer::requireFrame() const {
  if (current_) return;
  const DepthReadAhead::Counts counts = ahead_.counts();
  if (counts.lastLoss.empty()) throw Error("the depth stream ended before its first frame");
  throw Error("no frame of the depth stream could be read; the last one: {}", counts.lastLoss);
}

void DepthPlayer::playRecorded(double time_s) {
  const Place due = placeAt(time_s);
  const bool isBack = current_ && (current_->pass > due.pass ||
                                   (current_->pass == due.pass && !current_->isFirst && current_->time_s > due.time_s));
  const std::optional<Place> before = current_;
  if (isBack || ahead_.pass() < due.pass) {
    ahead_.restart(due.pass);
    current_.reset();
  }
  if (!options_.exact) ahead_.passOver(due.pass, due.time_s);
  // A pass begins with the first frame of it that could be read, however late that is.
  const auto isDue = [&](const Place& next) {
    if (!current_ || next.pass < due.pass) return true;
    return next.pass == due.pass && (next.time_s <= due.time_s || current_->pass < due.pass);
  };
  std::uint64_t taken = 0;
  while (const auto next = ahead_.peek(options_.exact || !current_)) {
    if (!isDue(*next)) break;
    takeNext(*next);
    ++taken;
  }
  if (!current_) current_ = before;  // what could be read once cannot be now
  const std::scoped_lock lock(mutex_);
  asked_s_ = time_s;
  played_ += taken > 0;
  if (taken > 0) noteView();
  if (!options_.exact && taken > 1) dropped_ += taken - 1;
}

void DepthPlayer::playLive(double time_s) {
  std::uint64_t taken = 0;
  while (!(isPaused() && current_) && ahead_.take(frame_, !current_)) {
    current_ = Place{.pass = 0, .time_s = frame_.time_s};
    ++taken;
  }
  if (taken > 0) {
    if (!liveOffset_s_) liveOffset_s_ = time_s - frame_.time_s;
    currentSince_s_ = std::min(time_s, frame_.time_s + *liveOffset_s_);
  }
  const std::scoped_lock lock(mutex_);
  asked_s_ = time_s;
  if (taken == 0) return;
  lastCame_s_ = time_s;
  ++played_;
  noteView();
  dropped_ += taken - 1;
}

void DepthPlayer::noteView() {
  view_.reset();
  if (frame_.pose) view_ = {.frustum = frustumOf(camera(), *frame_.pose), .number = frame_.number};
}

std::optional<PlayedView> DepthPlayer::view() const {
  const std::scoped_lock lock(mutex_);
  return view_;
}

DepthPlayer::Played DepthPlayer::frameAt(double time_s) {
  if (ahead_.stream().isRecorded())
    playRecorded(time_s);
  else
    playLive(time_s);
  requireFrame();
  return {.frame = frame_,
          .time_s = currentSince_s_,
          .serial = current_->pass * std::max<std::uint64_t>(1, ahead_.stream().frames()) + frame_.number};
}

void DepthPlayer::step() {
  if (!isPaused() || !current_) return;
  if (const auto next = ahead_.peek(true)) time_.stepTo(static_cast<double>(next->pass) * period_s_ + next->time_s);
}

PlayCounts DepthPlayer::counts() const {
  const DepthReadAhead::Counts read = ahead_.counts();
  const std::scoped_lock lock(mutex_);
  PlayCounts counts{.played = played_,
                    .lost = read.lost,
                    .dropped = read.dropped + dropped_,
                    .lastLoss = read.lastLoss,
                    .silentSince_s = {}};
  const bool isLive = !ahead_.stream().isRecorded();
  if (isLive && (read.ended || asked_s_ - lastCame_s_ > kSilent_s)) counts.silentSince_s = lastCame_s_;
  return counts;
}

}  // namespace palpate
