#include "engine/motion/depth_player.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr double kSilent_s = 1;
constexpr double kRounding_s = 1e-9;  // a frame due at a tick is not delayed to the next one by rounding
constexpr double kUsualRate_Hz = 30;  // assumed if there is only one frame

/// Duration of a pass, from its first frame to that of the next: includes one mean frame interval at the end.
double periodOf(const DepthStream& stream) {
  if (stream.frames() < 2 || !(stream.duration_s() > 0)) return 1 / kUsualRate_Hz;
  return stream.duration_s() * static_cast<double>(stream.frames()) / static_cast<double>(stream.frames() - 1);
}

/// Whether a frame comes after another one.
bool isBehind(const DepthReadAhead::Place& place, const DepthReadAhead::Place& other) {
  return place.pass != other.pass ? place.pass > other.pass : place.time_s > other.time_s;
}

}  // namespace

DepthPlayer::DepthPlayer(std::shared_ptr<DepthStream> stream, const PlayOptions& options,
                         std::optional<DepthFrame> first)
    : options_(options),
      ahead_(std::move(stream), options.loop),
      period_s_(periodOf(ahead_.stream())),
      time_(options.speed) {
  if (!first) return;
  frame_ = std::move(*first);
  current_ = Place{.pass = 0, .time_s = frame_.time_s};
  played_ = 1;
}

// Position in the recording at a session time.
DepthPlayer::Place DepthPlayer::placeAt(double time_s) const {
  const double place_s = time_.placeAt(time_s) + kRounding_s;
  if (!options_.loop || place_s < 0) return {.pass = 0, .time_s = place_s};
  const double pass = std::floor(place_s / period_s_);
  return {.pass = static_cast<std::uint64_t>(pass), .time_s = place_s - pass * period_s_};
}

// The current frame becomes the previous one.
void DepthPlayer::keepBefore() {
  std::swap(frame_, before_);
  beforeSince_s_ = current_ ? std::optional(currentSince_s_) : std::nullopt;
}

double DepthPlayer::lasts_s() {
  const double known_s = beforeSince_s_ ? currentSince_s_ - *beforeSince_s_ : period_s_;
  if (!ahead_.stream().isRecorded()) return known_s;
  const auto next = ahead_.peek(options_.exact);
  if (!next || next->pass != current_->pass) return known_s;
  return (next->time_s - current_->time_s) / time_.speed();
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

bool DepthPlayer::isBackAt(const Place& due) const {
  return current_ && (current_->pass > due.pass ||
                      (current_->pass == due.pass && !current_->isFirst && current_->time_s > due.time_s));
}

// A pass begins with its first readable frame, however late that is.
bool DepthPlayer::isDueAt(const Place& due, const Place& next) const {
  if (!current_ || next.pass < due.pass) return true;
  return next.pass == due.pass && (next.time_s <= due.time_s || current_->pass < due.pass);
}

void DepthPlayer::restart(std::uint64_t pass) {
  ahead_.restart(pass);
  current_.reset();
  beforeSince_s_.reset();
}

std::uint64_t DepthPlayer::takeDue(const Place& due) {
  if (!options_.exact) ahead_.passOver(due.pass, due.time_s);
  std::uint64_t taken = 0;
  while (const auto next = ahead_.peek(options_.exact || !current_)) {
    if (!isDueAt(due, *next)) break;
    // In real time the previous frame is the one that was played, not one that was due in between.
    if (options_.exact || taken == 0) keepBefore();
    if (current_ && next->pass != current_->pass) beforeSince_s_.reset();
    takeNext(*next);
    ++taken;
    if (options_.exact) break;
  }
  return taken;
}

void DepthPlayer::playRecorded(double time_s) {
  const Place due = placeAt(time_s);
  const std::optional<Place> before = current_;
  if (isBackAt(due) || ahead_.pass() < due.pass) {
    restart(due.pass);
    begin_.reset();
  }
  std::uint64_t taken = 0;
  while (const std::uint64_t more = takeDue(due)) {
    taken += more;
    if (!options_.exact) break;
  }
  if (!current_) current_ = before;  // a frame that was readable before no longer is
  count(time_s, options_.exact ? std::min<std::uint64_t>(taken, 1) : taken);
}

std::uint64_t DepthPlayer::takeLive(double time_s) {
  std::uint64_t taken = 0;
  const bool begins = !liveOffset_s_;
  if (begins && current_) liveOffset_s_ = time_s - frame_.time_s;
  while (!(isPaused() && current_) && ahead_.peek(!current_)) {
    if (taken == 0) keepBefore();
    ahead_.take(frame_, true);
    current_ = Place{.pass = 0, .time_s = frame_.time_s};
    ++taken;
  }
  if (taken > 0 && !liveOffset_s_) liveOffset_s_ = time_s - frame_.time_s;
  if (liveOffset_s_ && (taken > 0 || begins)) currentSince_s_ = std::min(time_s, frame_.time_s + *liveOffset_s_);
  if (!begins && taken == 0) return 0;
  const std::scoped_lock lock(mutex_);
  lastCame_s_ = time_s;
  return taken;
}

void DepthPlayer::playLive(double time_s) { count(time_s, takeLive(time_s)); }

void DepthPlayer::count(double time_s, std::uint64_t taken) {
  const std::scoped_lock lock(mutex_);
  // While a stream is held its frames are not taken: this does not count as silence.
  if (isPaused()) lastCame_s_ += std::max(0.0, time_s - asked_s_);
  asked_s_ = time_s;
  if (taken == 0) return;
  ++played_;
  noteView();
  dropped_ += taken - 1;
}

DepthPlayer::Played DepthPlayer::present() const {
  return {.frame = frame_,
          .time_s = currentSince_s_,
          .serial = current_->pass * std::max<std::uint64_t>(1, ahead_.stream().frames()) + frame_.number};
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
  Played played = present();
  if (beforeSince_s_) played.before = &before_;
  played.lasts_s = lasts_s();
  return played;
}

std::optional<DepthPlayer::Played> DepthPlayer::nextDue(double time_s) {
  rewindFor(time_s);
  const std::uint64_t taken = ahead_.stream().isRecorded() ? takeDue(placeAt(time_s)) : takeLive(time_s);
  count(time_s, taken);
  if (taken == 0) return std::nullopt;
  Played played = present();
  played.lasts_s = lasts_s();
  return played;
}

bool DepthPlayer::rewindFor(double time_s) {
  if (!ahead_.stream().isRecorded() || !isBackAt(placeAt(time_s))) return false;
  if (begin_ && !isBehind(*current_, *begin_)) return false;
  if (begin_)
    goBehind(*begin_);
  else
    restart(0);
  return true;
}

void DepthPlayer::goBehind(const Place& place) {
  restart(place.pass);
  while (const auto next = ahead_.peek(true)) {
    if (isBehind(*next, place)) break;
    takeNext(*next);
  }
  current_ = place;
}

void DepthPlayer::beginBehind(const Place& place) {
  goBehind(place);
  begin_ = place;
  const std::scoped_lock lock(mutex_);
  ++played_;
}

bool DepthPlayer::isOutdated(double time_s) const {
  const std::scoped_lock lock(mutex_);
  return !ahead_.stream().isRecorded() && time_s - lastCame_s_ > ahead_.stream().staysTrue_s();
}

void DepthPlayer::leaveOut(const std::string& why) {
  const std::scoped_lock lock(mutex_);
  --played_;
  ++leftOut_;
  lastLeftOut_ = why;
}

DepthPlayer::Losses DepthPlayer::takeLosses() {
  const DepthReadAhead::Counts read = ahead_.counts();
  const std::uint64_t before = std::exchange(lossesTaken_, read.lost);
  return {.frames = read.lost - before, .why = read.lastLoss};
}

void DepthPlayer::play(double time_s) {
  time_.play(time_s);
  // A session that takes over the player may have another time base, and may not have requested frames while it was
  // held.
  const std::scoped_lock lock(mutex_);
  lastCame_s_ = asked_s_ = time_s;
}

void DepthPlayer::hold(double time_s) {
  pause(time_s);
  if (current_) time_.stepTo(static_cast<double>(current_->pass) * period_s_ + current_->time_s);
}

void DepthPlayer::step() {
  if (!isPaused() || !current_) return;
  if (const auto next = ahead_.peek(true)) time_.stepTo(static_cast<double>(next->pass) * period_s_ + next->time_s);
}

PlayCounts DepthPlayer::counts() const {
  const DepthReadAhead::Counts read = ahead_.counts();
  const std::scoped_lock lock(mutex_);
  PlayCounts counts{.played = played_,
                    .lost = read.lost + leftOut_,
                    .dropped = read.dropped + dropped_,
                    .lastLoss = lastLeftOut_.empty() ? read.lastLoss : lastLeftOut_,
                    .silentSince_s = {}};
  const bool isLive = !ahead_.stream().isRecorded();
  counts.staysTrue_s = ahead_.stream().staysTrue_s();
  if (isLive && (read.ended || asked_s_ - lastCame_s_ > kSilent_s)) counts.silentSince_s = lastCame_s_;
  return counts;
}

}  // namespace palpate
