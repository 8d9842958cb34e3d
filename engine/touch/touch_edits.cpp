// The part of TouchSide that edits: the brush with each tick, the index that follows, its compaction, and changes as
// they are given.
#include <algorithm>
#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/point_cloud.hpp"
#include "engine/core/error.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/touch/touch_side.hpp"

namespace palpate {

namespace {

// Of the points: an edit that touches more is followed by a full build, which then takes less time.
constexpr double kLargeEdit = 1.0 / 16;

}  // namespace

void TouchSide::recordEdits() {
  const auto recorded = [&](auto&& record) {
    auto list = std::make_unique<CommandList>(device_, device_.touch(), "edit", options_.timing);
    list->begin();
    record(*list);
    list->end();
    return list;
  };
  const std::uint32_t parity = live_.parity();
  rebuilds_[parity].clear();
  incrementals_[parity] =
      recorded([&](CommandList& list) { edit_->recordIncremental(list, live_.side(), contact_.state()); });
  for (const SortMethod sort : {hash_.sort(), hash_.fallback()})
    for (const EditPass::Reach reach : {EditPass::Reach::box, EditPass::Reach::all})
      if (!rebuilds_[parity].contains({sort, reach}))
        rebuilds_[parity][{sort, reach}] = recorded([&](CommandList& list) {
          edit_->recordRebuild(list, live_.side(), live_.otherSide(), contact_.state(), sort, reach);
        });
}

void TouchSide::setBrush(const std::optional<BrushOptions>& brush) {
  if (!edit_) throw Error("{}: points can only be changed where they can be edited", machine());
  finish();
  brushOn_ = brush.has_value();
  if (!brush) return;
  options_.brush = brush;
  lastEdit_ = nullptr;
  edit_->setBrush(*brush);
  for (int turn = 0; turn < 2; ++turn) {
    recordEdits();
    live_.flip();
  }
}

const CommandList& TouchSide::chosenEdit() const {
  const bool rebuild = options_.index == IndexFollow::rebuild || largeEdits_;
  return rebuild ? *rebuilds_[live_.parity()].at({hash_.sort(), reach_}) : *incrementals_[live_.parity()];
}

void TouchSide::editIfYielding(bool realtime) {
  if (!edit_ || !brushOn_ || (last_.touching && !lastPose_.sculpts)) return;
  const bool yields = last_.touching && glm::distance(last_.proxy, lastPose_.hip) > options_.brush->tau;
  if (!yields && !edit_->unsettled()) return;
  if (realtime && !pace_.mayEdit(lastPose_.time_s)) {
    ++shortfalls_.editsTooSlow;
    return;
  }
  const CommandList& edit = chosenEdit();
  // Everything written so far has just been published, so this edit's own points are all that must fit.
  const bool updates = &edit == incrementals_[live_.parity()].get();
  if (!updates && !mayBuild(realtime)) {
    ++shortfalls_.editsHeldUp;
    return;
  }
  if (log_.room() < (updates ? edit_->mostMoves() : edit_->mostLogged(reach_))) {
    ++shortfalls_.editsLogFull;
    return;
  }
  if (!firstEditTime_s_) firstEditTime_s_ = lastPose_.time_s;
  submitEdit(edit);
  // In virtual time an edit that the index could not follow is done again at once, in real time with the next tick.
  if (!realtime) settleEdit();
}

void TouchSide::submitEdit(const CommandList& edit) {
  lastEdit_ = &edit;
  editTicket_ = device_.touch().submit(edit);
  editTime_s_ = lastPose_.time_s;
  editInFlight_ = inStroke_ = true;
  sinceEdit_ = Stopwatch();
  bridge_->edited(lastPose_.time_s);
  if (&edit == incrementals_[live_.parity()].get()) return;
  live_.flip();
  ++fullBuilds_;
}

void TouchSide::settleEdit() {
  collectEdit(true);
  while (edit_->report().failed != 0) {
    compact();  // so that the order of points in a bucket follows from the edits alone
    submitEdit(chosenEdit());
    collectEdit(true);
  }
}

void TouchSide::collectEdit(bool timed) {
  // Called when a later submission to the same queue has answered, so the edit's fence is about to follow.
  if (!editInFlight_) return collectCompaction(timed);
  device_.touch().wait(editTicket_, Wait::spin);
  const double time_us = timed ? lastEdit_->sectionTime_us("edit") : sinceEdit_.elapsed_us();
  const double wishes_us = timed ? lastEdit_->sectionTime_us("wishes") : 0;
  pace_.took(editTime_s_, (time_us + wishes_us) * 1e-6);
  editInFlight_ = false;
  if (editTimes_us_.size() < editTimes_us_.capacity()) {
    editTimes_us_.push_back(time_us);
    wishTimes_us_.push_back(wishes_us);
  }
  takeReport();
  collectCompaction(timed);
}

void TouchSide::takeReport() {
  const shared::HashUpdate& report = edit_->report();
  if (compaction_) compactionDue_ = compaction_->isDue(report);
  // For slots that a compaction is about to win back an edit waits: it is tried again, and the next one after it.
  const bool waits = report.failed == shared::kUpdateNoSlots && compaction_ && !compaction_->isIdle();
  shortfalls_.editsHeldUp += waits;
  shortfalls_.editsBuiltAnew += report.failed != 0 && !waits;
  const bool updated = lastEdit_ == incrementals_[0].get() || lastEdit_ == incrementals_[1].get();
  followed_ += updated && report.failed == 0;
  // An edit as large as the last one goes the same way, unless that is clearly the wrong one.
  const double share = (report.changed + report.gone) / std::max(1.0, static_cast<double>(live_.count()));
  // What fails with a build, too, has found more points than there is room for.
  if (report.failed & shared::kUpdateTooLarge) reach_ = EditPass::Reach::all;
  largeEdits_ = (report.failed != 0 && !waits) || share > (largeEdits_ ? kLargeEdit / 2 : kLargeEdit);
}

void TouchSide::compactFurther(bool realtime) {
  if (!compaction_) return;
  if (!realtime) {
    compaction_->settle();
    if (compactionDue_) noteCompaction(compaction_->run(), true);
    return;
  }
  compaction_->advance();
  if (compaction_->stage() == HashCompaction::Stage::copied)
    compaction_->end();
  else if (compaction_->isIdle() && compactionDue_)
    compaction_->begin();
}

void TouchSide::collectCompaction(bool timed) {
  if (!compaction_ || compaction_->stage() != HashCompaction::Stage::ending) return;
  device_.touch().wait(compaction_->endTicket(), Wait::spin);
  noteCompaction(compaction_->collect(), timed);
}

void TouchSide::noteCompaction(bool completed, bool timed) {
  compactionDue_ = compaction_->isDue(edit_->report());
  const double end_us = timed ? compaction_->endTime_us() : sinceAsked_.elapsed_us();
  longestCompactionEnd_us_ = std::max(longestCompactionEnd_us_, end_us);
  if (!completed) return;
  live_.flip();
  ++compactions_;
}

bool TouchSide::mayBuild(bool realtime) {
  if (!compaction_) return true;
  if (realtime)
    compaction_->abandon();
  else
    compaction_->settle();
  return compaction_->isIdle();
}
void TouchSide::endStroke() {
  if (std::exchange(inStroke_, false)) log_.endStroke();
}

void TouchSide::runAndFlip(const std::function<void(CommandList&, SortMethod)>& record) {
  mayBuild(false);
  for (SortMethod used = hash_.sort();; used = hash_.fallback()) {
    CommandList list(device_, device_.touch(), "build");
    list.begin();
    record(list, used);
    list.end();
    device_.touch().run(list);
    ++fullBuilds_;
    if (used == hash_.sort()) break;  // otherwise a bucket was crowded, and its points may stand in any order
  }
  live_.flip();
}

void TouchSide::compact() {
  runAndFlip([&](CommandList& list, SortMethod sort) {
    edit_->recordCompaction(list, live_.side(), live_.otherSide(), sort);
  });
}

void TouchSide::change(std::span<const PointChange> changes) {
  if (!edit_) throw Error("{}: points can only be changed where they can be edited", machine());
  finish();
  mayBuild(
      false);  // a compaction that runs on would miss marks that a change takes off points which it does not change
  if (log_.room() < changes.size())
    throw Error("{} changes do not fit beside what the readers of the edit log have not taken yet", changes.size());
  while (!changes.empty()) {
    const std::size_t batch = std::min<std::size_t>(changes.size(), edit_->mostChanges());
    changeBatch(changes.first(batch));
    changes = changes.subspan(batch);
  }
  log_.publishChange(download<std::uint32_t>(device_, log_.headBuffer(), 1)[0]);
  editsAnswered_ = log_.published();
  bridge_->edited(lastPose_.time_s);
}

void TouchSide::changeBatch(std::span<const PointChange> changes) {
  edit_->give(changes);
  if (options_.index == IndexFollow::incremental) {
    CommandList list(device_, device_.touch(), "change");
    list.begin();
    edit_->recordGivenIncremental(list, live_.side());
    list.end();
    device_.touch().run(list);
  }
  if (options_.index == IndexFollow::rebuild || edit_->report().failed != 0) {
    compact();  // the order of points in a bucket follows from the edits alone
    CommandList list(device_, device_.touch(), "change");
    list.begin();
    edit_->recordGivenRebuild(list, live_.side(), live_.otherSide(), hash_.sort());
    list.end();
    device_.touch().run(list);
    live_.flip();
    ++fullBuilds_;
    if (edit_->report().failed == 0) compact();  // a bucket may have been crowded in that build
  }
  if (edit_->report().failed & shared::kUpdateUnknown)
    throw Error("{}: a change names a point that is not where it says; nothing of it is done", machine());
  if (edit_->report().failed & shared::kUpdateNoSlots)
    throw Error("{}: there is no room for so many new points", machine());
}

std::size_t TouchSide::readBack(PointCloud& cloud) const {
  if (!edit_) return 0;
  auto present = live_.points();
  edit_->complete(present);
  auto states = statesOf(cloud);
  for (PointState& state : states) state.id |= PointState::kGone;
  for (const PointState& point : present) {
    for (auto id = static_cast<std::uint32_t>(states.size()); id <= point.id; ++id)
      states.push_back({.id = id | PointState::kGone});
    states[point.id] = point;
  }
  const std::size_t changed = changedPoints(cloud, states);
  cloud = editedCloud(cloud, states);
  return changed;
}

}  // namespace palpate
