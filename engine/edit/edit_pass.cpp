#include "engine/edit/edit_pass.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/edit/brush_reference.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kMostChanges = 1 << 16;

static_assert(sizeof(shared::EditEntry) == sizeof(PointState));
static_assert(shared::kPointGone == PointState::kGone);

PipelineOptions pipeline(std::uint32_t pushBytes, const HashUpdate& update) {
  return {.workgroupSize = shared::kUpdateWorkgroup,
          .pushBytes = pushBytes,
          .constants = {update.dispatch().countsGroups()}};
}

// Cells that a ball of `radius` may touch, along one side; 0 where they are more than the buckets.
std::uint64_t boxCells(const HashGrid& grid, double radius) {
  const double side = std::floor(2 * radius * static_cast<double>(grid.inverseCell)) + 3;
  return side * side * side > static_cast<double>(grid.bucketMask) ? 0 : static_cast<std::uint64_t>(side);
}

shared::EditEntry entryOf(const PointState& point) { return std::bit_cast<shared::EditEntry>(point); }

}  // namespace

EditPass::EditPass(Device& device, const BrushOptions& brush, const SpatialHash& hash, const LiveCloud& live,
                   const EditLog& log, std::span<const std::uint32_t> colors, double radius)
    : device_(device),
      options_(brush),
      hash_(hash),
      live_(live),
      log_(log),
      radius_(radius),
      update_(device, hash, live),
      mostChanges_(std::min(kMostChanges, update_.mostMoves())),
      boxCells_(boxCells(hash.grid(), brush.toolRadius)),
      collect_(device, shader_code::edit_collect, pipeline(sizeof(shared::CollectArgs), update_)),
      smooth_(device, shader_code::edit_smooth, pipeline(sizeof(shared::SmoothArgs), update_)),
      restore_(device, shader_code::edit_restore, pipeline(sizeof(shared::RestoreArgs), update_)),
      refit_(device, shader_code::edit_refit_normals, pipeline(sizeof(shared::RefitNormalsArgs), update_)),
      logGone_(device, shader_code::edit_log_gone, pipeline(sizeof(shared::RefitNormalsArgs), update_)),
      settle_(device, shader_code::edit_settle, pipeline(sizeof(shared::SettleArgs), update_)),
      brush_(Buffer::of<shared::Brush>(device, 1, Memory::device, "brush")),
      tables_(Buffer::of<shared::PointTables>(device, 1, Memory::device, "point tables")),
      colors_(Buffer::of<std::uint32_t>(device, colors.empty() ? 0 : live.slots(), Memory::device, "live colors")),
      parents_(Buffer::of<std::uint32_t>(device, live.slots() - live.count(), Memory::device, "parents")),
      changes_(Buffer::of<shared::GivenChange>(device, mostChanges_, Memory::upload, "given changes")) {
  upload(device, brush_, std::vector{sharedBrush(brush, radius)});
  if (!colors.empty()) {
    std::vector<std::uint32_t> byId(live.slots());
    std::ranges::copy(colors, byId.begin());
    upload(device, colors_, byId);
  }
  if (brush.keepsDensity && brush.kind != BrushKind::paint) resample_.emplace(device, live, update_, radius);
  upload(device, tables_,
         std::vector<shared::PointTables>{{.colors = colors.empty() ? 0 : colors_.address(),
                                           .parents = parents_.address(),
                                           .spacings = resample_ ? resample_->spacings() : 0,
                                           .rests = resample_ ? resample_->rests() : 0,
                                           .reaches = resample_ ? resample_->reaches() : 0,
                                           .looks = resample_ ? resample_->looks() : 0,
                                           .lists = resample_ ? resample_->lists() : 0,
                                           .moves = update_.moves(),
                                           .marks = update_.marks(),
                                           .touched = update_.touched(),
                                           .movesOf = update_.bySlot(),
                                           .firstNew = live.count(),
                                           .ids = live.slots(),
                                           .mostMoves = update_.mostMoves(),
                                           .unused = 0}});
  if (resample_) resample_->measure(view(live.side()), tables_.address());
}

void EditPass::setBrush(const BrushOptions& brush) {
  options_ = brush;
  boxCells_ = boxCells(hash_.grid(), brush.toolRadius);
  upload(device_, brush_, std::vector{sharedBrush(brush, radius_)});
}

Resample::Io EditPass::resampleIo(const shared::CloudView& cloud, std::uint32_t parity) const {
  return {.update = update_.args(cloud, parity), .tables = tables_.address(), .lists = update_};
}

EditPass::Selection EditPass::box() const {
  return boxCells_ > 0 ? Selection{.cells = static_cast<std::uint32_t>(boxCells_)} : Selection{.slots = live_.slots()};
}

void EditPass::recordCollect(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                             DeviceAddress contactState, const Selection& selection, std::uint32_t recalls) const {
  const shared::HashUpdateArgs update = update_.args(cloud, parity);
  const std::uint32_t recalling =
      recalls == shared::kRecallsNothing ? 0 : update_.dispatch().sharedGroups(CountedDispatch::Step::subgroup);
  const std::uint64_t groups = std::uint64_t{shared::selectGroups(selection.cells, selection.slots)} + recalling;
  list.dispatch(collect_, groups * shared::kUpdateWorkgroup,
                shared::CollectArgs{.cloud = cloud,
                                    .update = update.update,
                                    .capacities = update.capacities,
                                    .state = contactState,
                                    .brush = brush_.address(),
                                    .tables = tables_.address(),
                                    .recalls = recalls,
                                    .cells = selection.cells,
                                    .firstSlot = selection.firstSlot,
                                    .slots = selection.slots});
}

void EditPass::recordSmooth(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                            DeviceAddress contactState) const {
  const shared::HashUpdateArgs update = update_.args(cloud, parity);
  update_.dispatch()(list, smooth_, CountedDispatch::Step::subgroup, update_.counters(),
                     offsetof(shared::HashUpdate, movedGroups),
                     shared::SmoothArgs{.cloud = cloud,
                                        .update = update.update,
                                        .capacities = update.capacities,
                                        .state = contactState,
                                        .brush = brush_.address(),
                                        .tables = tables_.address()});
}

void EditPass::recordIncremental(CommandList& list, const LiveCloud::Side& side, const Buffer& contactState) const {
  const shared::CloudView cloud = view(side);
  const DeviceAddress state = contactState.address();
  const std::uint32_t recalls = resamples() ? shared::kRecallsWishes : shared::kRecallsNothing;
  {
    const auto edit = list.section("edit");
    {
      const auto section = list.section("brush");
      recordMoves(list, cloud, side.parity, state, box(), recalls);
    }
    update_.recordApply(list, cloud, side.parity);
    recordSequel(list, cloud, side.parity, scratch(), true);
  }
  recordWishes(list, cloud, side.parity, scratch());
}

void EditPass::recordMoves(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                           DeviceAddress contactState, const Selection& selection, std::uint32_t recalls) const {
  if (options_.kind != BrushKind::smooth) return recordCollect(list, cloud, parity, contactState, selection, recalls);
  // By the neighbours as they all still stand.
  recordCollect(list, cloud, parity, contactState, selection, shared::kRecallsNothing);
  recordSmooth(list, cloud, parity, contactState);
  if (recalls != shared::kRecallsNothing) recordCollect(list, cloud, parity, contactState, {}, recalls);
}

void EditPass::recordRebuild(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                             const Buffer& contactState, SortMethod sort, Reach reach) const {
  const DeviceAddress state = contactState.address();
  const std::uint32_t recalls = resamples() ? shared::kRecallsWishes : shared::kRecallsNothing;
  {
    const auto edit = list.section("edit");
    recordReached(list, from, state, recalls, reach);
    hash_.recordBuild(list, from, to, live_.slots(), sort);
    update_.recordRecount(list, view(to), to.parity, scratch(from).changed);
    recordSequel(list, view(to), to.parity, scratch(from), true);
  }
  recordWishes(list, view(to), to.parity, scratch(from));
}

void EditPass::recordReached(CommandList& list, const LiveCloud::Side& from, DeviceAddress state, std::uint32_t recalls,
                             Reach reach) const {
  const shared::CloudView cloud = view(from);
  const auto section = list.section("brush");
  if (reach == Reach::box && boxCells_ > 0) {
    recordMoves(list, cloud, from.parity, state, box(), recalls);
  } else {
    for (std::uint32_t first = 0; first < live_.slots(); first += update_.mostMoves()) {
      const Selection slots{.firstSlot = first, .slots = std::min(update_.mostMoves(), live_.slots() - first)};
      recordMoves(list, cloud, from.parity, state, slots, shared::kRecallsNothing);
      update_.recordCommit(list, cloud);
      recordLogging(list, logGone_, CountedDispatch::Step::invocation, offsetof(shared::HashUpdate, moveGroups), cloud,
                    from.parity, {});
      update_.recordBegin(list);
    }
    if (resamples()) recordCollect(list, cloud, from.parity, state, {}, recalls);
  }
  update_.recordCommit(list, cloud);
}

void EditPass::give(std::span<const PointChange> changes) {
  PALPATE_CHECK_LE(changes.size(), mostChanges_);
  const auto given = changes_.mapped<shared::GivenChange>();
  for (std::size_t i = 0; i < changes.size(); ++i) {
    PALPATE_CHECK_EQ(changes[i].from.number(), changes[i].to.number());
    PALPATE_CHECK_LT(changes[i].to.number(), live_.slots());
    given[i] = {.from = entryOf(changes[i].from), .to = entryOf(changes[i].to)};
  }
  given_ = static_cast<std::uint32_t>(changes.size());
}

void EditPass::recordRestore(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                             bool finishes) const {
  const shared::HashUpdateArgs update = update_.args(cloud, parity);
  list.dispatch(restore_, std::uint64_t{given_} * device_.subgroupSize(),
                shared::RestoreArgs{.cloud = cloud,
                                    .update = update.update,
                                    .capacities = update.capacities,
                                    .changes = changes_.address(),
                                    .tables = tables_.address(),
                                    .lists = resample_ ? resample_->lists() : 0,
                                    .count = given_,
                                    .finishes = finishes ? 1u : 0u});
}

void EditPass::recordGivenIncremental(CommandList& list, const LiveCloud::Side& side) const {
  const shared::CloudView cloud = view(side);
  update_.recordBegin(list);
  if (resample_) recordCollect(list, cloud, side.parity, 0, {}, shared::kForgetsWishes);
  recordRestore(list, cloud, side.parity, false);
  update_.recordApply(list, cloud, side.parity);
  recordRestore(list, cloud, side.parity, true);
  recordSequel(list, cloud, side.parity, scratch(), false);
}

void EditPass::recordGivenRebuild(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                                  SortMethod sort) const {
  update_.recordBegin(list);
  if (resample_) recordCollect(list, view(from), from.parity, 0, {}, shared::kForgetsWishes);
  recordRestore(list, view(from), from.parity, false);
  update_.recordCommit(list, view(from));
  recordRestore(list, view(from), from.parity, true);
  hash_.recordBuild(list, from, to, live_.slots(), sort);
  update_.recordRecount(list, view(to), to.parity, scratch(from).changed);
  recordSequel(list, view(to), to.parity, scratch(from), false);
}

void EditPass::recordCompaction(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                                SortMethod sort) const {
  update_.recordBegin(list);
  hash_.recordBuild(list, from, to, live_.slots(), sort);
  update_.recordRecount(list, view(to), to.parity, scratch(from).changed);
  update_.recordEnd(list);
}

void EditPass::recordLogging(CommandList& list, const ComputePipeline& pass, CountedDispatch::Step step,
                             std::uint64_t groups, const shared::CloudView& cloud, std::uint32_t parity,
                             const Scratch& scratch) const {
  const shared::HashUpdateArgs update = update_.args(cloud, parity);
  update_.dispatch()(list, pass, step, update_.counters(), groups,
                     shared::RefitNormalsArgs{.cloud = cloud,
                                              .update = update.update,
                                              .changed = scratch.changed,
                                              .fitted = scratch.fitted,
                                              .entries = log_.entries(),
                                              .head = log_.head(),
                                              .tables = tables_.address(),
                                              .lists = wishLists(),
                                              .capacityMask = static_cast<std::uint32_t>(log_.capacity() - 1),
                                              .radius = static_cast<float>(radius_)});
}

void EditPass::recordSequel(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                            const Scratch& scratch, bool wishes) const {
  using Step = CountedDispatch::Step;
  constexpr std::uint64_t kGroups = offsetof(shared::HashUpdate, changedGroups);
  const shared::HashUpdateArgs update = update_.args(cloud, parity);
  const auto section = list.section("refit normals");
  recordLogging(list, refit_, Step::subgroup, kGroups, cloud, parity, scratch);
  update_.dispatch()(list, settle_, Step::invocation, update_.counters(), kGroups,
                     shared::SettleArgs{.cloud = cloud,
                                        .update = update.update,
                                        .changed = scratch.changed,
                                        .fitted = scratch.fitted,
                                        .head = log_.head(),
                                        .lists = wishLists(),
                                        .end = wishes && resamples() ? shared::EditEnd{} : end()});
}

void EditPass::recordWishes(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                            const Scratch& scratch) const {
  if (!resamples()) return;
  const auto section = list.section("wishes");
  resample_->recordWishes(list, resampleIo(cloud, parity), scratch.changed, scratch.fitted, end());
}

shared::EditEnd EditPass::end() const {
  return {.report = update_.reportAddress(),
          .resampling = resamples() ? resample_->reportAddress() : 0,
          .empty = update_.emptyCounters()};
}

void EditPass::complete(std::vector<PointState>& points) const {
  const auto parents = download<std::uint32_t>(device_, parents_, live_.slots() - live_.count());
  const auto byId = download<std::uint32_t>(device_, colors_, colors_.bytes() / sizeof(std::uint32_t));
  for (PointState& point : points) {
    if (point.id >= live_.count()) point.parent = parents[point.id - live_.count()];
    if (!byId.empty()) point.color = byId[point.id];
  }
}

std::uint64_t EditPass::mostLogged(Reach reach) const {
  return reach == Reach::box && boxCells_ > 0 ? update_.mostMoves() : live_.slots();
}

std::uint64_t EditPass::bytes() const {
  return update_.bytes() + (resample_ ? resample_->bytes() : 0) + brush_.bytes() + tables_.bytes() + colors_.bytes() +
         parents_.bytes() + changes_.bytes();
}

std::uint64_t EditPass::predictedBytes(std::uint64_t points, bool colors) {
  constexpr std::uint64_t kWord = sizeof(std::uint32_t);
  const std::uint64_t spare = HashUpdate::spareSlots(points);
  const std::uint64_t changes = std::min<std::uint64_t>(kMostChanges, HashUpdate::defaultMoves(points));
  return HashUpdate::predictedBytes(points) + kWord * spare + (colors ? kWord * (points + spare) : 0) +
         changes * sizeof(shared::GivenChange) +
         Resample::predictedBytes(points, points + spare, HashUpdate::defaultMoves(points));
}

}  // namespace palpate
