#include "engine/touch/cpu_edits.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/core/thread_priority.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxOffered = 1 << 12;  // changes: they take less than the time of a tick
constexpr std::uint64_t kEditRoom = 1 << 22;

}  // namespace

CpuEdits::CpuEdits(CpuSculpture& sculpture, const std::optional<BrushOptions>& brush, const Setting& setting)
    : sculpture_(sculpture),
      brush_(brush),
      setting_(setting),
      stroke_(setting.radius),
      pace_(kStalest_s),
      queue_(setting.room ? setting.room : std::max<std::uint64_t>(kEditRoom, 4 * sculpture.points().size())),
      offered_(brush && !brush->resample ? kMaxOffered : 0) {
  collect();
  if (!brush) return;
  stroke_.setBrush(*brush);
  statistics_.editTimes_us.reserve(kEditTimesKept);
  task_ = std::make_unique<BackgroundTask>([this] {
    giveWay();  // lowers the priority below the answering thread
    edit();
  });
}

void CpuEdits::setBrush(const std::optional<BrushOptions>& brush) {
  brush_ = brush;
  stroke_.setBrush(brush.value_or(BrushOptions()));
}

void CpuEdits::feel(const Contact& contact, const Pose& pose) {
  if (!brush_) return;
  const DVec3 spring = contact.touching ? contact.proxy - pose.hip : DVec3(0);
  stroke_.feel(contact, pose.hip - setting_.origin, spring, pose.press(), pose.time_s);
  if (contact.isWithin && pose.press() == Press::button && !stroke_.isGoingOn()) blocked_.noteBehind();
  if (!stroke_.isGoingOn() && sculpture_.settled()) markStroke();
}

bool CpuEdits::editIfYielding(double time_s, bool realtime) {
  if (!brush_ || (!stroke_.acts() && sculpture_.settled())) return false;
  if (realtime && !pace_.mayEdit(time_s)) {
    ++statistics_.shortfalls.editsTooSlow;
    return false;
  }
  if (realtime && queue_.room().free == 0) {
    ++statistics_.shortfalls.editsLogFull;
    return false;
  }
  if (!realtime && !workPace_.mayEdit(time_s)) return false;
  begin(time_s, realtime);
  return true;
}

void CpuEdits::begin(double time_s, bool realtime) {
  work_.brush.emplace(*brush_, setting_.radius, stroke_.next(time_s, sculpture_.backlog()));
  work_.size = setting_.size.value_or(realtime ? EditSize::tick : EditSize::whole);
  if (work_.brush->acts() && std::exchange(strokeMarked_, stroke_.number()) != stroke_.number()) markStroke();
  if (!statistics_.firstEditTime_s) statistics_.firstEditTime_s = time_s;
  time_s_ = time_s;
  inStroke_ = true;
  work_.isOffer = false;
  begin();
}

void CpuEdits::begin() {
  isUnderWay_ = isBegun_ = true;
  ++version_;
}

void CpuEdits::start() {
  if (std::exchange(isBegun_, false)) task_->start();
}

bool CpuEdits::takeUpOffer(double time_s, bool realtime) {
  if (isUnderWay_ || !offered_.isThere() || (realtime && queue_.room().free == 0)) return false;
  if (realtime && !pace_.mayEdit(time_s)) {
    ++statistics_.shortfalls.offersTooSlow;
    return false;
  }
  time_s_ = time_s;
  work_.isOffer = true;
  work_.inStroke = inStroke_;
  begin();
  return true;
}

// Points that the brush has changed since the offer keep the brush's state; after a change() that the offering thread
// did not know of, all do.
void CpuEdits::carryOut() {
  const Stopwatch watch;
  standing_.clear();
  if (offered_.changesFollowed() == changes_)
    for (const PointChange& change : offered_.changes())
      if (sculpture_.points().state(static_cast<std::uint32_t>(change.to.number)) == change.from)
        standing_.push_back(change);
  if (!standing_.empty()) sculpture_.receive(standing_);
  work_.states += standing_.size();
  if (work_.inStroke) queue_.mark(EditMark::Kind::part);
  queue_.append(
      standing_.size(), [&](std::size_t i) { return standing_[i].to; }, EditMark::Kind::received);
  offered_.done();
  work_.time_us = watch.elapsed_us();
}

void CpuEdits::edit() {
  if (work_.isOffer) return carryOut();
  const Stopwatch watch;
  sculpture_.edit(*work_.brush, work_.size);
  const auto changed = sculpture_.changed();
  queue_.append(changed.size(), [&](std::size_t i) { return sculpture_.points().state(changed[i]); });
  work_.states += changed.size();
  work_.time_us = watch.elapsed_us();
}

bool CpuEdits::finishedWithin(double budget_us) {
  if (!isUnderWay_) return true;
  start();
  if (!task_->finishedWithin(budget_us)) return false;
  isUnderWay_ = false;
  answered_ = work_.states;
  collect();
  pace_.took(time_s_, work_.time_us * 1e-6);
  if (work_.isOffer) return true;
  workPace_.took(time_s_, sculpture_.work());
  stroke_.note(sculpture_.measure());
  collected_.touched = static_cast<std::uint32_t>(sculpture_.changed().size());
  const bool meets = stroke_.tool().acts == 0 || sculpture_.measure().weights > 0;
  blocked_.note(stroke_.tool().stroke, sculpture_.measure().blocked, collected_.touched, meets);
  if (statistics_.editTimes_us.size() < statistics_.editTimes_us.capacity())
    statistics_.editTimes_us.push_back(work_.time_us);
  return true;
}

void CpuEdits::collect() {
  collected_.index = {.followed = sculpture_.followed(), .built = sculpture_.rebuilds()};
  collected_.memory = {.points = sculpture_.points().size() * 2 * sizeof(Vec3), .index = sculpture_.grid().bytes()};
}

void CpuEdits::wait() const {
  if (task_) task_->finishedWithin(0);
}

void CpuEdits::finish() {
  finishedWithin(0);
  const auto edit = [this] {
    begin(time_s_ + 1e-3, false);
    finishedWithin(0);
  };
  while (stroke_.hasWay() && workPace_.mayComplete(time_s_)) edit();
  statistics_.shortfalls.pathsDropped += stroke_.hasWay();
  stroke_.end();
  while (brush_ && !sculpture_.settled()) edit();
  workPace_ = {};
  markStroke();
}

void CpuEdits::markStroke() {
  if (std::exchange(inStroke_, false)) queue_.mark(EditMark::Kind::stroke);
}

void CpuEdits::change(std::span<const PointChange> changes, double time_s) {
  if (changes.empty()) return;
  const auto isThere = [&](const PointChange& change) {
    if (change.from.number >= sculpture_.points().size()) return change.from.gone;
    const PointState state = sculpture_.points().state(static_cast<std::uint32_t>(change.from.number));
    return state.gone == change.from.gone && (state.gone || state.position == change.from.position);
  };
  if (!std::ranges::all_of(changes, isThere))
    throw Error("a change refers to a point that is not at the stated position; no point was changed");
  sculpture_.set(changes);
  collect();
  queue_.append(
      changes.size(), [&](std::size_t i) { return changes[i].to; }, EditMark::Kind::change);
  ++changes_;
  ++version_;
  answered_ = work_.states += changes.size();
  if (!statistics_.firstEditTime_s) statistics_.firstEditTime_s = time_s;
}

void CpuEdits::replace(const PointSet& changed, std::span<const PointState> states, const PointSet& without) {
  sculpture_.replace(changed, states, without);
  collect();
  ++changes_;
  ++version_;
}

}  // namespace palpate
