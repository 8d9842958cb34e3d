#include "engine/edit/journal.hpp"

#include <utility>

#include "engine/core/check.hpp"

namespace palpate {

void Journal::follow(const EditBatch& batch) {
  const std::span<const PointState> all = batch.points;
  std::size_t begin = 0;
  for (const EditMark& mark : batch.marks) {
    PALPATE_CHECK(begin <= mark.at && mark.at <= all.size());
    const auto states = all.subspan(begin, mark.at - begin);
    switch (mark.kind) {
      case EditMark::Kind::stroke:
        addToStroke(states);
        endStroke();
        break;
      case EditMark::Kind::change:
        endStroke();  // in case its end was not marked
        points_.set(states);
        break;
      case EditMark::Kind::part:
        addToStroke(states);
        break;
      case EditMark::Kind::received:
        receive(states);
        break;
    }
    begin = mark.at;
  }
  addToStroke(all.subspan(begin));
}

void Journal::receive(std::span<const PointState> states) {
  if (states.empty()) return;
  ++received_;
  points_.set(states);
  if (!undoList_.keepsAny()) return;
  lastReceived_.resize(points_.size(), 0);
  for (const PointState& state : states) {
    const std::uint32_t point = state.number();
    lastReceived_[point] = received_;
    if (!isInStroke(point)) continue;
    // From now on the stroke's edits of this point start from the received state.
    open_.points[slot_[point]] = open_.points.back();
    slot_[open_.points.back().number()] = slot_[point];
    open_.points.pop_back();
  }
}

void Journal::addToStroke(std::span<const PointState> states) {
  if (states.empty()) return;
  if (!std::exchange(inStroke_, true)) {
    undoList_.begin();
    keepsStroke_ = undoList_.keepsAny();
    open_.version = version_;
  }
  version_ = ++lastVersion_;
  for (const PointState& state : states) {
    if (keepsStroke_ && !isInStroke(state.number())) keepBefore(state.number());
    points_.set(state);
  }
}

void Journal::keepBefore(std::uint32_t point) {
  keepsStroke_ = undoList_.makeRoom(bytesOf(open_) + sizeof(PointState));
  if (!keepsStroke_) {
    open_ = {};
    return;
  }
  if (point >= slot_.size()) slot_.resize(point + 1);
  slot_[point] = static_cast<std::uint32_t>(open_.points.size());
  open_.points.push_back(points_[point]);
}

void Journal::endStroke() {
  if (!std::exchange(inStroke_, false)) return;
  ++strokes_;
  if (keepsStroke_) {
    open_.received = received_;
    open_.points.shrink_to_fit();
    undoList_.add(std::move(open_));
  } else {
    undoList_.addTooLarge();
  }
  open_ = {};
}

void Journal::leaveReceived(PointStroke& stroke) {
  if (!lastReceived_.empty())
    std::erase_if(stroke.points, [&](const PointState& point) {
      return point.number() < lastReceived_.size() && lastReceived_[point.number()] > stroke.received;
    });
  stroke.received = received_;
}

std::vector<PointChange> Journal::cross(PointStroke& stroke) {
  leaveReceived(stroke);
  std::vector<PointChange> changes;
  changes.reserve(stroke.points.size());
  std::swap(version_, stroke.version);
  for (PointState& other : stroke.points) {
    const PointState present = points_[other.number()];
    changes.push_back({.from = present, .to = other});
    points_.set(other);
    other = present;
  }
  return changes;
}

std::vector<PointChange> Journal::undo() {
  PALPATE_CHECK(!inStroke_);
  std::vector<PointChange> changes;
  undoList_.undo([&](PointStroke& stroke) { changes = cross(stroke); });
  return changes;
}

std::vector<PointChange> Journal::redo() {
  PALPATE_CHECK(!inStroke_);
  std::vector<PointChange> changes;
  undoList_.redo([&](PointStroke& stroke) { changes = cross(stroke); });
  return changes;
}

}  // namespace palpate
