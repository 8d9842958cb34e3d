#include "engine/touch/edit_pipeline.hpp"

#include <algorithm>
#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/point_cloud.hpp"
#include "engine/core/error.hpp"
#include "engine/core/held_contact.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

namespace {

// Share of the points: a larger edit is followed by a full build, which is then faster.
constexpr double kLargeEdit = 1.0 / 16;
constexpr std::size_t kMaxOffered = 1 << 14;  // changes: applied between two ticks

std::size_t mostOffered(const EditPass& pass) {
  return pass.brush().resample ? 0 : std::min<std::size_t>(kMaxOffered, pass.mostChanges());
}

}  // namespace

EditPipeline::EditPipeline(Device& device, const EditOptions& options, LiveIndex& index, EditLog& log,
                           TouchStatistics& statistics, std::span<const std::uint32_t> colors)
    : device_(device),
      options_(options),
      index_(index),
      log_(log),
      statistics_(statistics),
      pass_(device, options.brush, index.hash(), index.cloud(), log, colors, options.radius),
      stroke_(options.radius),
      head_(Buffer::of<std::uint32_t>(device, 1, Memory::readback, "head of the edit log")),
      readsHead_(device, device.latencyQueue(), "read head"),
      offered_(mostOffered(pass_)),
      pace_(kStalest_s) {
  if (offered_.most() > 0)
    offer_.list = std::make_unique<CommandList>(device, device.latencyQueue(), "offer", options.timing);
  readsHead_.begin();
  readsHead_.copy(log.headBuffer(), head_, head_.bytes());
  readsHead_.end();
  stroke_.setBrush(options.brush);
  statistics_.editTimes_us.reserve(kEditTimesKept);
  statistics_.requestTimes_us.reserve(kEditTimesKept);
}

void EditPipeline::record() {
  const auto recorded = [&](auto&& record) {
    auto list = std::make_unique<CommandList>(device_, device_.latencyQueue(), "edit", options_.timing);
    list->begin();
    record(*list);
    list->end();
    return list;
  };
  const LiveCloud& cloud = index_.cloud();
  Lists& lists = lists_[cloud.parity()];
  last_.list = nullptr;
  lists.rebuilds.clear();
  using Reach = EditPass::Reach;
  for (const Reach reach : {Reach::near, Reach::far})
    lists.incremental[reach] =
        recorded([&](CommandList& list) { pass_.recordIncremental(list, cloud.front(), reach); });
  for (const SortMethod sort : {index_.hash().sort(), index_.hash().fallback()})
    for (const Reach reach : {Reach::near, Reach::far, Reach::all})
      if (!lists.rebuilds.contains({sort, reach}))
        lists.rebuilds[{sort, reach}] =
            recorded([&](CommandList& list) { pass_.recordRebuild(list, cloud.front(), cloud.back(), sort, reach); });
}

void EditPipeline::followIndex() {
  if (options_.index == IndexFollow::incremental) index_.follow(pass_.update(), options_.compaction);
}

void EditPipeline::setBrush(const std::optional<BrushOptions>& brush) {
  brushOn_ = brush.has_value();
  stroke_.setBrush(brush.value_or(BrushOptions()));
  if (!brush) return;
  pass_.setBrush(*brush);
  for (int turn = 0; turn < 2; ++turn) {
    record();
    index_.flip();
  }
}

const CommandList& EditPipeline::chosen() const {
  const Lists& lists = lists_[index_.parity()];
  const bool rebuild = options_.index == IndexFollow::rebuild || next_.large;
  return rebuild ? *lists.rebuilds.at({index_.hash().sort(), reach()}) : *lists.incremental.at(pass_.reach());
}

bool EditPipeline::updates(const CommandList& list) const {
  const auto holds = [&](const Lists& lists) {
    return std::ranges::any_of(lists.incremental, [&](const auto& entry) { return entry.second.get() == &list; });
  };
  return holds(lists_[0]) || holds(lists_[1]);
}

void EditPipeline::feel(const Contact& contact, const Pose& pose, const DVec3& origin) {
  if (!brushOn_) return;
  const DVec3 spring = contact.touching ? contact.proxy - pose.hip : DVec3(0);
  stroke_.feel(contact, pose.hip - origin, spring, pose.press(), pose.time_s);
  if (contact.isWithin && pose.press() == Press::button && !stroke_.isGoingOn()) blocked_.noteBehind();
  if (!stroke_.isGoingOn() && !pass_.unsettled()) markStroke();
}

bool EditPipeline::editIfYielding(double time_s, bool realtime) {
  if (!brushOn_ || (!stroke_.acts() && !pass_.unsettled())) return false;
  if (realtime && !pace_.mayEdit(time_s)) {
    ++statistics_.shortfalls.editsTooSlow;
    return false;
  }
  const CommandList& list = chosen();
  // All earlier entries have just been published, so only this edit's own points must fit.
  if (!updates(list) && !index_.mayBuild(realtime)) {
    ++statistics_.shortfalls.editsHeldUp;
    return false;
  }
  if (log_.room() < (updates(list) ? pass_.mostMoves() : pass_.mostLogged(reach()))) {
    ++statistics_.shortfalls.editsLogFull;
    return false;
  }
  const bool acts = stroke_.acts();
  pass_.setTool(stroke_.next(time_s));
  if (acts && std::exchange(strokeMarked_, stroke_.number()) != stroke_.number()) markStroke();
  if (!statistics_.firstEditTime_s) statistics_.firstEditTime_s = time_s;
  submit(chosen(), time_s);
  // In virtual time an edit that the index could not follow is repeated at once, in real time with the next tick.
  if (!realtime) settle();
  return true;
}

void EditPipeline::submit(const CommandList& list, double time_s) {
  last_.list = &list;
  last_.ticket = device_.latencyQueue().submit(list);
  last_.time_s = time_s;
  last_.isUnderWay = inStroke_ = true;
  lastWasOffer_ = false;
  last_.since = Stopwatch();
  if (!updates(list)) index_.built();
}

void EditPipeline::settle() {
  collect(nullptr);
  while (pass_.report().failed != 0) {
    compact();  // so that the order of points in a bucket depends only on the edits
    submit(chosen(), last_.time_s);
    collect(nullptr);
  }
}

bool EditPipeline::takeUpOffer(double time_s, bool realtime) {
  if (isUnderWay() || !offered_.isThere()) return false;
  if (realtime && !pace_.mayEdit(time_s)) {
    ++statistics_.shortfalls.offersTooSlow;
    return false;
  }
  // A change() intervened: the offered points may have moved since, or already be present.
  if (offered_.changesFollowed() != changes_) {
    offer_.isDone = true;
    offer_.hasFailed = false;
    publish(static_cast<std::uint32_t>(log_.published()));
    return false;
  }
  offer_.rebuilds = options_.index == IndexFollow::rebuild || offer_.hasFailed;
  if (log_.room() < offered_.changes().size() || (offer_.rebuilds && !index_.mayBuild(realtime))) return false;
  if (offer_.hasFailed) compact();  // points that reappear need slots, which are contiguous then
  submitOffer(time_s);
  if (realtime) return true;
  collectOffer(nullptr);
  if (offer_.hasFailed) {
    compact();
    offer_.rebuilds = true;
    submitOffer(time_s);
    collectOffer(nullptr);
  }
  publish(logHead());
  return true;
}

void EditPipeline::submitOffer(double time_s) {
  const LiveCloud& cloud = index_.cloud();
  pass_.give(offered_.changes());
  CommandList& list = *offer_.list;
  list.begin();
  {
    const auto section = list.section("offer");
    if (offer_.rebuilds)
      pass_.recordGivenRebuild(list, cloud.front(), cloud.back(), index_.hash().sort(), EditPass::Given::offered);
    else
      pass_.recordGivenIncremental(list, cloud.front(), EditPass::Given::offered);
  }
  list.end();
  offer_.ticket = device_.latencyQueue().submit(list);
  offer_.isUnderWay = lastWasOffer_ = true;
  offer_.since = {};
  offer_.time_s = time_s;
  if (offer_.rebuilds) index_.built();
}

void EditPipeline::collectOffer(const Stopwatch* sinceAsked) {
  device_.latencyQueue().wait(offer_.ticket, device_.defaultWait());
  const double time_us = sinceAsked ? offer_.since.elapsed_us() : offer_.list->sectionTime_us("offer");
  pace_.took(offer_.time_s, time_us * 1e-6);
  offer_.isUnderWay = false;
  index_.readReport();
  const bool failed = pass_.report().failed != 0;
  if (failed && offer_.rebuilds) throw Error("{}: changes by other participants could not be applied", device_.name());
  if (!failed && !offer_.rebuilds) index_.followed();
  offer_.hasFailed = failed;
  offer_.isDone = !failed;
}

void EditPipeline::publish(std::uint32_t head) {
  if (!std::exchange(offer_.isDone, false)) return log_.publish(head);
  log_.publishReceived(head, inStroke_);
  offered_.done();
}

std::uint32_t EditPipeline::logHead() const {
  device_.latencyQueue().run(readsHead_);
  return head_.mapped<std::uint32_t>()[0];
}

void EditPipeline::collect(const Stopwatch* sinceAsked) {
  // Called after a later submission to the same queue has answered, so the edit's fence is about to be signalled.
  if (offer_.isUnderWay) collectOffer(sinceAsked);
  if (!last_.isUnderWay) return index_.collectCompaction(sinceAsked);
  device_.latencyQueue().wait(last_.ticket, device_.defaultWait());
  const double time_us = sinceAsked ? last_.since.elapsed_us() : last_.list->sectionTime_us("edit");
  const double requests_us = sinceAsked ? 0 : last_.list->sectionTime_us("requests");
  pace_.took(last_.time_s, (time_us + requests_us) * 1e-6);
  last_.isUnderWay = false;
  if (statistics_.editTimes_us.size() < statistics_.editTimes_us.capacity()) {
    statistics_.editTimes_us.push_back(time_us);
    statistics_.requestTimes_us.push_back(requests_us);
  }
  takeReport();
  index_.collectCompaction(sinceAsked);
}

// Reads the report of the last edit, for the next one.
void EditPipeline::takeReport() {
  const shared::HashUpdate& report = pass_.report();
  const SurfaceMeasure sum = pass_.measure(), measured = sum - std::exchange(measured_, sum);
  stroke_.note(measured);
  const std::uint32_t changed = report.changed + report.gone;
  // Smoothing lists all points in its reach. An edit that failed is repeated.
  const std::uint32_t listed =
      brushHas(pass_.brush().kind, shared::kUsesNeighbours) ? std::min(changed, measured.blocked) : 0;
  const bool meets = stroke_.tool().acts == 0 || measured.weights > 0;
  if (report.failed == 0) blocked_.note(stroke_.tool().stroke, measured.blocked, changed - listed, meets);
  index_.readReport();
  // If a running compaction is about to free slots, the edit waits: it is retried, and so is the next one.
  const bool waits = report.failed == shared::kUpdateNoSlots && index_.isCompacting();
  statistics_.shortfalls.editsHeldUp += waits;
  statistics_.shortfalls.editsRebuilt += report.failed != 0 && !waits;
  if (updates(*last_.list) && report.failed == 0) index_.followed();
  // The next edit uses the same method as the last one, unless its size clearly calls for the other.
  const double share = changed / std::max(1.0, static_cast<double>(index_.cloud().count()));
  // kUpdateTooLarge: the edit found more points than there is room for.
  if (report.failed & shared::kUpdateTooLarge) next_.all = true;
  next_.large = (report.failed != 0 && !waits) || share > (next_.large ? kLargeEdit / 2 : kLargeEdit);
}

void EditPipeline::finish() {
  collect(nullptr);
  publish(logHead());
  while (stroke_.hasWay() && editIfYielding(last_.time_s + 1e-3, false)) publish(logHead());
  stroke_.end();
  while (pass_.unsettled() && editIfYielding(last_.time_s + 1e-3, false)) publish(logHead());
  markStroke();
}

void EditPipeline::markStroke() {
  if (std::exchange(inStroke_, false)) log_.endStroke();
}

void EditPipeline::compact() {
  const LiveCloud& cloud = index_.cloud();
  index_.buildNow(
      [&](CommandList& list, SortMethod sort) { pass_.recordCompaction(list, cloud.front(), cloud.back(), sort); });
}

void EditPipeline::change(std::span<const PointChange> changes) {
  // A compaction that continued would miss marks that a change clears on points it does not change.
  index_.mayBuild(false);
  if (log_.room() < changes.size())
    throw Error("{} changes do not fit into the edit log: its readers are too far behind", changes.size());
  for (std::size_t done = 0; done < changes.size();) {
    const auto batch = changes.subspan(done, std::min<std::size_t>(changes.size() - done, pass_.mostChanges()));
    const std::uint32_t failed = changeBatch(batch, EditPass::Given::exactly);
    if (failed & shared::kUpdateUnknown) {
      revert(changes.first(done));
      throw Error("{}: a change refers to a point that is not at the stated position; no point was changed",
                  device_.name());
    }
    done += batch.size();
    if (failed & shared::kUpdateNoSlots) {
      revert(changes.first(done));
      throw Error("{}: there is not enough room for the new points; no point was changed", device_.name());
    }
  }
  changes_ += log_.publishChange(logHead());
}

void EditPipeline::replace(const PointSet& changed, std::span<const PointState> states, const PointSet& without) {
  index_.mayBuild(false);
  const LiveCloud& cloud = index_.cloud();
  CommandList list(device_, device_.latencyQueue(), "forget");
  list.begin();
  pass_.recordForgetting(list, cloud.front());
  list.end();
  device_.latencyQueue().run(list);
  pass_.carryOut(changed, states, without);
  index_.flip();
  compact();
  ++changes_;
}

// Takes back changes whose entries are not published, and their entries.
void EditPipeline::revert(std::span<const PointChange> changes) {
  const std::vector<std::uint32_t> head{static_cast<std::uint32_t>(log_.published())};
  upload(device_, log_.headBuffer(), head);  // the entries of the reversed changes must not overwrite unread ones
  std::vector<PointChange> back;
  for (std::size_t done = 0; done < changes.size(); done += back.size()) {
    const auto batch = changes.subspan(done, std::min<std::size_t>(changes.size() - done, pass_.mostChanges()));
    back.clear();
    for (const PointChange& change : batch) back.push_back({.from = change.to, .to = change.from});
    changeBatch(back, EditPass::Given::offered);  // new points for which there was no room are left out
  }
  upload(device_, log_.headBuffer(), head);
}

std::uint32_t EditPipeline::changeBatch(std::span<const PointChange> changes, EditPass::Given given) {
  const LiveCloud& cloud = index_.cloud();
  pass_.give(changes);
  if (options_.index == IndexFollow::incremental) {
    CommandList list(device_, device_.latencyQueue(), "change");
    list.begin();
    pass_.recordGivenIncremental(list, cloud.front(), given);
    list.end();
    device_.latencyQueue().run(list);
  }
  if (options_.index == IndexFollow::rebuild || pass_.report().failed != 0) {
    compact();  // so that the order of points in a bucket depends only on the edits
    CommandList list(device_, device_.latencyQueue(), "change");
    list.begin();
    pass_.recordGivenRebuild(list, cloud.front(), cloud.back(), index_.hash().sort(), given);
    list.end();
    device_.latencyQueue().run(list);
    index_.built();
    if (pass_.report().failed == 0) compact();  // a bucket may have overflowed in that build
  }
  return pass_.report().failed;
}

std::size_t EditPipeline::readBack(PointCloud& cloud) const {
  auto present = index_.cloud().points();
  pass_.complete(present);
  auto states = statesOf(cloud);
  for (PointState& state : states) state.gone = true;
  for (const PointState& point : present) {
    while (states.size() <= point.number) states.push_back({.gone = true, .number = states.size()});
    states[point.number] = point;
  }
  const std::size_t changed = changedPoints(cloud, states);
  cloud = editedCloud(cloud, states);
  return changed;
}

}  // namespace palpate
