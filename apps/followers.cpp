#include "apps/followers.hpp"

#include <algorithm>
#include <chrono>

namespace palpate {

namespace {

constexpr double kRate_Hz = 30;
constexpr double kBetweenFlushes_s = 0.5;  // of the log, in virtual time
constexpr std::size_t kMostWaitingEdits = 1 << 18;
constexpr std::size_t kLeastNew = 1 << 16;
constexpr int kLooksPerTurn = 8;  // whether the ring of a GPU fills up faster than usual

}  // namespace

Followers::Followers(Context& context, const Model& model, TouchBackend& backend, const FollowersWanted& wanted)
    : model_(model), backend_(backend), log_(wanted.log), touchSide_(dynamic_cast<TouchSide*>(&backend)) {
  byHost_ = wanted.sight && !(touchSide_ && wanted.sight == &context.device());
  if (wanted.picture && (touchSide_ || byHost_)) {
    // The CPU numbers new points without end; so many of them are seen.
    const std::size_t mostNew = std::max<std::size_t>(kLeastNew, model.cloud.size());
    const std::uint64_t spare = touchSide_ ? touchSide_->live().slots() - touchSide_->live().count() : mostNew;
    drawn_.emplace(wanted.sight ? *wanted.sight : context.device(), model.cloud,
                   DrawnOptions{.spare = static_cast<std::uint32_t>(spare),
                                .painted = touchSide_ ? touchSide_->paints() : true,
                                .spacing = model.spacing,
                                .edited = !touchSide_ || touchSide_->edits() != nullptr});
    if (!byHost_) drawnReader_.emplace(touchSide_->editLog());
  }
  if (!wanted.journal) return;
  journal_.emplace(model.cloud, wanted.undo_bytes);
  backend.keepEdits();
}

TickObserver Followers::begin(double rate_Hz, bool realtime) {
  if (!drawn_ && !journal_ && !log_) return {};
  if (!realtime) {
    period_ = static_cast<std::uint64_t>(std::max(1.0, rate_Hz / kRate_Hz));
    return [this](const TraceRow& row) { observe(row); };
  }
  thread_ = std::jthread([this](const std::stop_token& stop) {
    try {
      while (!stop.stop_requested()) {
        catchUp();
        for (int look = 0; look < kLooksPerTurn && !isHalfFull(); ++look)
          std::this_thread::sleep_for(std::chrono::duration<double>(1 / kRate_Hz / kLooksPerTurn));
      }
    } catch (...) {
      failure_ = std::current_exception();
    }
  });
  return {};
}

bool Followers::isNearlyFull() const {
  return touchSide_ && touchSide_->editLog().room() < 2 * std::uint64_t{model_.cloud.size()};
}

bool Followers::isHalfFull() const {
  return touchSide_ && touchSide_->editLog().room() < touchSide_->editLog().capacity() / 2;
}

void Followers::observe(const TraceRow& row) {
  const bool flushes =
      log_ && (row.time_s >= lastFlush_s_ + kBetweenFlushes_s || log_->waitingEdits() > kMostWaitingEdits);
  if (++ticks_ % period_ == 0 || flushes || isNearlyFull()) catchUp();
  if (!flushes) return;
  log_->flush();
  lastFlush_s_ = row.time_s;
}

void Followers::catchUp() {
  draw();
  if (!journal_) return;
  batch_.clear();
  backend_.takeEdits(batch_);
  if (batch_.empty()) return;
  if (byHost_ && drawn_) drawn_->catchUp(batch_.points);
  if (log_) log_->add(batch_);
  journal_->follow(batch_);
}

void Followers::draw() {
  if (!drawnReader_) return;
  try {
    drawn_->catchUp(*drawnReader_);
  } catch (...) {
    drawnReader_.reset();  // the hand, the journal and the log go on without the picture
    drawingFailure_ = std::current_exception();
  }
}

DrawnCloud* Followers::drawn() {
  if (drawingFailure_) std::rethrow_exception(drawingFailure_);
  return drawn_ ? &*drawn_ : nullptr;
}

void Followers::finish() {
  stop();
  catchUp();
  if (failure_) std::rethrow_exception(failure_);
}

StrokesTakenBack takeBack(TouchBackend& backend, Journal& journal, const std::function<void()>& follow,
                          std::size_t undo, std::size_t redo) {
  StrokesTakenBack back;
  using Turn = std::vector<PointChange> (Journal::*)();
  const auto apply = [&](Turn turn, Turn opposite) {
    const std::vector<PointChange> changes = (journal.*turn)();
    if (changes.empty()) return false;
    try {
      backend.change(changes);
      follow();
    } catch (...) {
      (journal.*opposite)();
      throw;
    }
    return true;
  };
  while (back.undone < undo && apply(&Journal::undo, &Journal::redo)) ++back.undone;
  while (back.redone < redo && apply(&Journal::redo, &Journal::undo)) ++back.redone;
  back.strokes = journal.strokes();
  back.dropped = journal.dropped();
  back.tooLarge = journal.tooLarge();
  return back;
}

}  // namespace palpate
