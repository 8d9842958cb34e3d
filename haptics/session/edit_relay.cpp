#include "haptics/session/edit_relay.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

#include "engine/core/start_thread.hpp"
#include "haptics/session/recorded_edits.hpp"

namespace palpate {

namespace {

constexpr double kBetweenFlushes_s = 0.5;  // of the log, in virtual time
constexpr std::size_t kMaxWaitingEdits = 1 << 18;
constexpr double kBetweenChecks_s = 1.0 / 240;  // of checking whether the back end's edit log fills faster than usual

}  // namespace

EditRelay::EditRelay(const PointCloud& cloud, LayerAttributes& attributes, EditStream* edits, ShapeStrokes* shape,
                     const RelayOptions& options)
    : cloud_(cloud), attributes_(attributes), edits_(edits), shape_(shape), options_(options) {
  if (!options.keepsPoints && !shape_) return;
  history_.emplace(options.keepsPoints && !options.isPart ? PointStates(cloud) : PointStates(), options.undo);
  history_->setStrokeLayers(attributes.strokeLayers());
  if (options.keepsPoints && edits_) edits_->keep();
}

TickObserver EditRelay::begin(double rate_Hz, bool realtime) {
  if (options_.followers.empty() && !history_ && !options_.log) return {};
  if (!realtime) {
    period_ = static_cast<std::uint64_t>(std::max(1.0, rate_Hz / options_.rate_Hz));
    return [this](const TraceRow& row) { observe(row); };
  }
  thread_ = startThread([this](const std::stop_token& stop) {
    try {
      while (!stop.stop_requested()) {
        catchUp();
        const double turn_s = 1 / options_.rate_Hz;
        for (double slept_s = 0; slept_s < turn_s && !isHalfFull(); slept_s += kBetweenChecks_s)
          std::this_thread::sleep_for(std::chrono::duration<double>(std::min(turn_s - slept_s, kBetweenChecks_s)));
      }
    } catch (...) {
      failure_ = std::current_exception();
    }
  });
  return {};
}

bool EditRelay::isNearlyFull() const {
  const auto room = edits_ ? edits_->room() : std::nullopt;
  return room && room->free < 2 * std::uint64_t{cloud_.size()};
}

bool EditRelay::isHalfFull() const {
  const auto room = edits_ ? edits_->room() : std::nullopt;
  return room && room->free < room->capacity / 2;
}

void EditRelay::observe(const TraceRow& row) {
  SessionWriter* const log = options_.log;
  const bool flushes =
      log && (row.time_s >= lastFlush_s_ + kBetweenFlushes_s || log->waitingEdits() > kMaxWaitingEdits);
  if (++ticks_ % period_ == 0 || flushes || isNearlyFull()) catchUp();
  if (!flushes) return;
  log->flush();
  lastFlush_s_ = row.time_s;
}

void EditRelay::catchUp() {
  batch_.clear();
  std::swap(batch_, changed_);
  if (keepsPoints() && edits_) edits_->take(batch_);
  if (std::exchange(endsInStroke_, false)) markStroke();
  if (!batch_.empty()) {
    if (options_.log) options_.log->add(batch_);
    attributes_.follow(batch_, history_->points());
    history_->follow(batch_, std::exchange(isKnown_, false));
  }
  if (options_.isPart) batch_.clear();
  if (shape_) {
    std::vector<ShapeStroke> strokes;
    shape_->take(strokes);
    history_->follow(std::move(strokes));
  }
  for (EditFollower*& follower : options_.followers) {
    try {
      follower->catchUp(batch_);
    } catch (...) {
      follower = nullptr;  // the hand, the history and the log continue without it
      if (!followerFailure_) followerFailure_ = std::current_exception();
    }
  }
  std::erase(options_.followers, nullptr);
}

// The states before the mark of the change belong to a stroke; the change itself, which followers count, is empty.
void EditRelay::markStroke() {
  const auto last =
      std::ranges::find(batch_.marks.rbegin(), batch_.marks.rend(), EditMark::Kind::change, &EditMark::kind);
  if (last != batch_.marks.rend())
    batch_.marks.insert(std::prev(last.base()), {.at = last->at, .kind = EditMark::Kind::stroke});
}

void EditRelay::checkFollower() const {
  if (followerFailure_) std::rethrow_exception(followerFailure_);
}

void EditRelay::finish() {
  stop();
  catchUp();
  if (failure_) std::rethrow_exception(failure_);
}

void EditRelay::exchange(AttributeChange& change, EditMark::Kind kind, bool inBackEnd) {
  changed_.marks.reserve(changed_.marks.size() + 1);
  changed_.attributes.push_back(change);
  bool isExchanged = false;
  try {
    attributes_.exchange(change);
    isExchanged = true;
    const auto* const flip = std::get_if<MaskFlip>(&change);
    if (inBackEnd && flip && flip->role == MaskRole::hidden) applyHidden();
    if (inBackEnd && attributes_.isOfLock(change)) applyLock();
  } catch (...) {
    if (isExchanged) attributes_.exchange(change);
    changed_.attributes.pop_back();
    throw;
  }
  changed_.marks.push_back({0, kind});
}

void EditRelay::applyLock() {
  if (!edits_) return;
  if (keepsPoints())
    edits_->lock(attributes_.lock(cloud_, history_->points()));
  else
    edits_->lock(attributes_.lock(cloud_, PointStates(cloud_)));
}

void EditRelay::applyHidden() {
  if (!edits_) return;
  edits_->hide(attributes_.mask(MaskRole::hidden),
               [this]() -> std::span<const PointState> { return history_->points(); });
}

void EditRelay::applyMasks() {
  if (options_.isPart) return;
  const bool locks = !attributes_.mask(MaskRole::locked).empty() || !attributes_.mask(MaskRole::within).empty();
  if (locks || attributes_.hasLockField(cloud_)) applyLock();
  if (!attributes_.mask(MaskRole::hidden).empty()) applyHidden();
}

void EditRelay::change(AttributeChange change) {
  catchUp();
  history_->make(std::move(change), [&](AttributeChange& made) { exchange(made, EditMark::Kind::attribute); });
  catchUp();
}

void EditRelay::setPoints(std::span<const PointChange> changes) {
  catchUp();
  edits_->change(changes);
  endsInStroke_ = true;
  catchUp();
}

void EditRelay::noteLayer(StrokeLayerChange change, EditMark::Kind kind) {
  changed_.marks.reserve(changed_.marks.size() + 1);
  changed_.attributes.emplace_back(std::move(change));
  changed_.marks.push_back({0, kind});
}

void EditRelay::slide(StrokeLayerChange change) {
  catchUp();
  const PointLock lock = attributes_.lock(cloud_, history_->points());
  const std::uint32_t number = change.number;
  history_->slide(change, &lock, [&](const PointSet& points, const History::MadeChanges& changes) {
    noteLayer(change, EditMark::Kind::attribute);
    try {
      return endsInStroke_ = carryMany()(points, changes);
    } catch (...) {
      changed_.clear();
      throw;
    }
  });
  const StrokeLayers& layers = attributes_.strokeLayers();
  if (!endsInStroke_)
    noteLayer({.number = number, .set = layers[number], .open = layers.open()}, EditMark::Kind::attribute);
  catchUp();
}

// A stroke of a layer has the states of its points.
void EditRelay::changePresence(const PointSet& points) {
  catchUp();
  if (attributes_.strokeLayers().open()) {
    BareVector<PointState> states;
    points.forEach([&](std::uint64_t point) {
      states.push_back(history_->points()[point]);
      states.back().gone = !states.back().gone;
    });
    return changeMany(std::move(states));
  }
  history_->changePresence(points, carryMany());
  endsInStroke_ = true;
  catchUp();
}

void EditRelay::changeMany(BareVector<PointState> states) {
  catchUp();
  history_->changeMany(std::move(states), carryMany());
  endsInStroke_ = true;
  catchUp();
}

History::CarryMany EditRelay::carryMany() {
  return [this](const PointSet& points, const History::MadeChanges& changes) {
    if (options_.isPart || !edits_->changeMany(points, history_->points())) edits_->change(changes());
    isKnown_ = true;
    return true;
  };
}

// Undoes and redoes them all; where that fails, the followers learn how far it came.
EditBatch EditRelay::attributeHistory() {
  catchUp();
  const auto isUndone = [&](EditMark::Kind kind) {
    const History::Carriers carriers{.points = [](std::span<const PointChange>) { return false; },
                                     .shape = [](ShapeStroke&) { return false; },
                                     .attributes =
                                         [&](AttributeChange& change) {
                                           exchange(change, kind, false);
                                           return true;
                                         }};
    return kind == EditMark::Kind::undone ? history_->undo(carriers) : history_->redo(carriers);
  };
  std::size_t made = 0, undone = 0;
  while (isUndone(EditMark::Kind::undone)) ++made;
  EditBatch past{.attributes = attributes_.all()};
  const std::size_t before = past.attributes.size();
  // From here on each of them is made, and then some are undone.
  const auto begin = static_cast<std::ptrdiff_t>(changed_.attributes.size());
  while (isUndone(EditMark::Kind::redone)) ++undone;
  for (undone -= made; undone > 0; --undone) isUndone(EditMark::Kind::undone);
  past.attributes.insert(past.attributes.end(), changed_.attributes.begin() + begin, changed_.attributes.end());
  past.marks.assign(before, {0, EditMark::Kind::attribute});
  past.marks.insert(past.marks.end(), changed_.marks.begin() + begin, changed_.marks.end());
  for (EditMark& mark : past.marks)
    if (mark.kind == EditMark::Kind::redone) mark.kind = EditMark::Kind::attribute;
  changed_.clear();
  return past;
}

// The followers get the present masks and fields.
void EditRelay::followAgain(const EditBatch& edits) {
  palpate::followAgain(*history_, attributes_, edits);
  changed_.attributes = attributes_.all();
}

History::Carriers EditRelay::carriers(const EditMark::Kind& kind) {
  return {.points =
              [this](std::span<const PointChange> changes) {
                edits_->change(changes);
                return true;
              },
          .many = carryMany(),
          .shape =
              [this](ShapeStroke& stroke) {
                shape_->exchange(stroke);
                return true;
              },
          .attributes =
              [this, &kind](AttributeChange& change) {
                exchange(change, kind);
                return true;
              },
          .layers = [this, &kind](StrokeLayerChange change) { noteLayer(std::move(change), kind); }};
}

bool EditRelay::takeBack() {
  const EditMark::Kind kind = EditMark::Kind::undone;
  const bool isDone = history_ && history_->takeBack(carriers(kind));
  if (isDone) catchUp();
  return isDone;
}

UndoneStrokes EditRelay::undo(std::size_t undo, std::size_t redo) {
  UndoneStrokes done;
  if (!history_) return done;
  EditMark::Kind kind = EditMark::Kind::undone;
  const History::Carriers carriers = this->carriers(kind);
  const auto next = [&] {
    const HistoryChange* const change = history_->last();
    return change ? std::optional(inWords(*change, history_->points(), attributes_)) : std::nullopt;
  };
  for (; done.undone < undo; ++done.undone, catchUp()) {
    ChangeInWords last = next().value_or(ChangeInWords());
    if (!history_->undo(carriers)) break;
    done.last = std::move(last);
  }
  kind = EditMark::Kind::redone;
  for (; done.redone < redo && history_->redo(carriers); ++done.redone, catchUp())
    done.last = next().value_or(ChangeInWords());
  done.next = next();
  const StrokeCounts counts = history_->counts();
  done.strokes = counts.strokes;
  done.dropped = counts.dropped;
  done.tooLarge = counts.tooLarge;
  return done;
}

}  // namespace palpate
