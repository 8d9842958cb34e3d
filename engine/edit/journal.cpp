#include "engine/edit/journal.hpp"

#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/check.hpp"

namespace palpate {

Journal::Journal(const PointCloud& file, std::uint64_t budget_bytes)
    : budget_(budget_bytes),
      points_(statesOf(file)),
      present_(points_.size()),
      slot_(budget_bytes ? points_.size() : 0) {}

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
        set(states);
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

void Journal::growTo(std::uint32_t point) {
  while (points_.size() <= point) {
    const auto id = static_cast<std::uint32_t>(points_.size());
    points_.push_back({.id = id | PointState::kGone, .parent = id});
  }
  if (budget_) slot_.resize(points_.size());
}

void Journal::set(std::span<const PointState> states) {
  for (const PointState& state : states) {
    const std::uint32_t point = state.number();
    if (point >= points_.size()) growTo(point);
    put(state);
  }
}

void Journal::put(const PointState& state) {
  PointState& point = points_[state.number()];
  present_ += point.gone();
  present_ -= state.gone();
  point = state;
}

void Journal::receive(std::span<const PointState> states) {
  if (states.empty()) return;
  ++received_;
  set(states);
  if (!budget_) return;
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
    for (const Stroke& stroke : undone_) bytes_ -= bytesOf(stroke);
    undone_.clear();
    keepsStroke_ = budget_ > 0;
    open_.version = version_;
    measureRoom();
  }
  version_ = ++lastVersion_;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!keepsStroke_) return set(states.subspan(i));
    const std::uint32_t point = states[i].number();
    if (point >= points_.size()) growTo(point);
    if (!isInStroke(point)) keepBefore(point);
    put(states[i]);
  }
}

void Journal::measureRoom() {
  const std::uint64_t used = bytes_ + sizeof(Stroke);
  room_ = used < budget_ ? (budget_ - used) / sizeof(PointState) : 0;
}

void Journal::keepBefore(std::uint32_t point) {
  while (open_.points.size() >= room_ && !done_.empty()) {
    bytes_ -= bytesOf(done_.front());
    done_.pop_front();
    ++dropped_;
    measureRoom();
  }
  if (open_.points.size() >= room_) {
    open_ = {};
    keepsStroke_ = false;
    return;
  }
  slot_[point] = static_cast<std::uint32_t>(open_.points.size());
  open_.points.push_back(points_[point]);
}

void Journal::endStroke() {
  if (!std::exchange(inStroke_, false)) return;
  ++strokes_;
  if (keepsStroke_) {
    open_.received = received_;
    open_.points.shrink_to_fit();
    bytes_ += bytesOf(open_);
    done_.push_back(std::move(open_));
  } else if (budget_) {
    ++dropped_;
    ++tooLarge_;
  }
  open_ = {};
}

void Journal::leaveReceived(Stroke& stroke) {
  if (!lastReceived_.empty())
    std::erase_if(stroke.points, [&](const PointState& point) {
      return point.number() < lastReceived_.size() && lastReceived_[point.number()] > stroke.received;
    });
  stroke.received = received_;
}

std::vector<PointChange> Journal::cross(Stroke& stroke) {
  bytes_ -= bytesOf(stroke);
  leaveReceived(stroke);
  bytes_ += bytesOf(stroke);
  std::vector<PointChange> changes;
  changes.reserve(stroke.points.size());
  std::swap(version_, stroke.version);
  for (PointState& other : stroke.points) {
    const PointState present = points_[other.number()];
    changes.push_back({.from = present, .to = other});
    put(other);
    other = present;
  }
  return changes;
}

std::vector<PointChange> Journal::undo() {
  PALPATE_CHECK(!inStroke_);
  if (done_.empty()) return {};
  undone_.push_back(std::move(done_.back()));
  done_.pop_back();
  return cross(undone_.back());
}

std::vector<PointChange> Journal::redo() {
  PALPATE_CHECK(!inStroke_);
  if (undone_.empty()) return {};
  done_.push_back(std::move(undone_.back()));
  undone_.pop_back();
  return cross(done_.back());
}

}  // namespace palpate
