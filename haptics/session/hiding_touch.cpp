#include "haptics/session/hiding_touch.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/check.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

constexpr double kLarge = 1.0 / 16;  // of the points: from there on a replacement is sooner than changes, or as soon

bool isLarge(std::uint64_t changed, std::size_t points) {
  return static_cast<double>(changed) > kLarge * static_cast<double>(points);
}

// Inserts states before the mark with that index.
void insertBefore(EditBatch& batch, std::size_t mark, std::span<const PointState> states) {
  const auto at = static_cast<std::ptrdiff_t>(batch.marks[mark].at);
  batch.points.insert(batch.points.begin() + at, states.begin(), states.end());
  for (std::size_t i = mark; i < batch.marks.size(); ++i) batch.marks[i].at += states.size();
}

// Adds the states to the first action of that kind from mark `begin` on; without one, as an action of their own.
void addStates(EditBatch& batch, std::size_t begin, EditMark::Kind kind, std::vector<PointState>& states) {
  if (states.empty()) return;
  std::size_t mark = begin;
  while (mark < batch.marks.size() && batch.marks[mark].kind != kind) ++mark;
  if (mark == batch.marks.size()) {
    // What precedes it belongs to a stroke that continues.
    const std::size_t last = batch.marks.empty() ? 0 : batch.marks.back().at;
    if (batch.points.size() > last) batch.marks.push_back({batch.points.size(), EditMark::Kind::part});
    batch.marks.push_back({batch.points.size(), kind});
    mark = batch.marks.size() - 1;
  }
  insertBefore(batch, mark, states);
  states.clear();
}

}  // namespace

// Points that were hidden one by one appear so, since a picture that reads the log knows nothing of a replacement.
void HidingTouch::hide(const PointSet& points, const PresentStates& present) {
  PALPATE_CHECK(changed_.empty() && received_.empty());
  present_ = present;
  const std::span<const PointState> states = present_();
  PointSet flipped = hidden_;
  flipped.flip(points);
  PointSet hidden = points, logged = logged_, appear = logged_;
  appear.remove(points);
  logged.remove(appear);
  if (isLarge(flipped.count(), states.size())) {
    if (!appear.empty()) flip(appear, states);
    logged_ = std::move(logged);
    hidden_.remove(appear);
    flipped.remove(appear);
    if (stream().replace(flipped, states, points)) {
      ++hidings_;
      hidden_ = std::move(hidden);
      return;
    }
    logged = logged_;
  }
  PointSet vanish = points;
  vanish.remove(hidden_);
  logged.add(vanish);
  flip(flipped, states);
  logged_ = std::move(logged);
  hidden_ = std::move(hidden);
}

void HidingTouch::flip(const PointSet& points, std::span<const PointState> present) {
  std::vector<PointChange> changes;
  points.forEach([&](std::uint64_t point) {
    if (point >= present.size() || present[point].gone) return;
    PointState state = present[point], gone = state;
    gone.gone = true;
    changes.push_back(hidden_.test(point) ? PointChange{gone, state} : PointChange{state, gone});
  });
  if (changes.empty()) return;
  stream().change(changes);
  ++hidings_;
  // Only its own states are left out: a stroke may have ended before it.
  stream().take(left_);
  PALPATE_CHECK(!left_.marks.empty() && left_.marks.back() == (EditMark{left_.points.size(), EditMark::Kind::change}));
  left_.points.resize(left_.points.size() - changes.size());
  left_.marks.pop_back();
  unreported_ += static_cast<std::int64_t>(changes.size());
}

std::vector<PointState> HidingTouch::takeHidden(std::vector<PointChange>& changes) const {
  std::vector<PointState> states;
  std::erase_if(changes, [&](const PointChange& change) {
    if (!hidden_.test(change.to.number)) return false;
    states.push_back(change.to);
    return true;
  });
  return states;
}

void HidingTouch::change(std::span<const PointChange> changes) {
  if (hidden_.empty()) return stream().change(changes);
  std::vector<PointChange> felt(changes.begin(), changes.end());
  std::vector<PointState> hidden = takeHidden(felt);
  stream().change(felt);
  changed_ = std::move(hidden);
}

bool HidingTouch::changeMany(const PointSet& points, std::span<const PointState> states) {
  const std::uint64_t count = points.count();
  if (!isLarge(count, states.size()) || !stream().replace(points, states, hidden_)) return false;
  stream().take(left_);
  const std::size_t before = left_.points.size();
  left_.points.resize(before + count);
  const std::vector<PointSet::Word> words = points.list();
  parallelFor(words.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      words[i].forEach([&](std::uint64_t point, std::uint64_t k) { left_.points[before + k] = states[point]; });
  });
  left_.marks.push_back({left_.points.size(), EditMark::Kind::change});
  left_.hasMoreThanLog = true;
  unreported_ -= static_cast<std::int64_t>(count);
  return true;
}

bool HidingTouch::offer(std::span<const PointChange> changes, std::uint64_t changesFollowed) {
  if (hidden_.empty()) return stream().offer(changes, changesFollowed + hidings_);
  if (!received_.empty()) return false;
  std::vector<PointChange> felt(changes.begin(), changes.end());
  std::erase_if(felt, [&](const PointChange& change) {
    return hidden_.test(change.to.number) && !(present_()[change.to.number] == change.from);
  });
  std::vector<PointState> hidden = takeHidden(felt);
  if (!felt.empty() && !stream().offer(felt, changesFollowed + hidings_)) return false;
  received_ = std::move(hidden);
  isOfferedAlone_ = felt.empty();
  return true;
}

void HidingTouch::take(EditBatch& batch) {
  const std::size_t begin = batch.marks.size(), first = batch.points.size();
  if (first == 0)
    std::swap(batch.points, left_.points);  // they may be gigabytes
  else
    batch.points.insert(batch.points.end(), left_.points.begin(), left_.points.end());
  for (const EditMark& mark : left_.marks) batch.marks.push_back({first + mark.at, mark.kind});
  batch.hasMoreThanLog |= left_.hasMoreThanLog;
  left_.clear();
  stream().take(batch);
  unreported_ -= static_cast<std::int64_t>(changed_.size());
  addStates(batch, begin, EditMark::Kind::change, changed_);
  const auto isReceived = [](const EditMark& mark) { return mark.kind == EditMark::Kind::received; };
  const auto marks = std::span(batch.marks).subspan(begin);
  if (!std::exchange(isOfferedAlone_, false) && std::ranges::none_of(marks, isReceived)) return;
  unreported_ -= static_cast<std::int64_t>(received_.size());
  addStates(batch, begin, EditMark::Kind::received, received_);
}

EditProgress HidingTouch::progress() const noexcept {
  EditProgress progress = stream().progress();
  progress.states -= static_cast<std::uint64_t>(unreported_.load(std::memory_order_relaxed));
  return progress;
}

}  // namespace palpate
