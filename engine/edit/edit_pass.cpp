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

PipelineOptions pipeline(std::uint32_t pushBytes) {
  return {.workgroupSize = shared::kUpdateWorkgroup, .pushBytes = pushBytes};
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
      select_(device, shader_code::edit_select, pipeline(sizeof(shared::SelectArgs))),
      smooth_(device, shader_code::edit_smooth, pipeline(sizeof(shared::SmoothArgs))),
      restore_(device, shader_code::edit_restore, pipeline(sizeof(shared::RestoreArgs))),
      logGone_(device, shader_code::edit_log_gone, pipeline(sizeof(shared::LogGoneArgs))),
      refit_(device, shader_code::edit_refit_normals, pipeline(sizeof(shared::RefitNormalsArgs))),
      brush_(Buffer::of<shared::Brush>(device, 1, Memory::device, "brush")),
      colors_(Buffer::of<std::uint32_t>(device, colors.empty() ? 0 : live.slots(), Memory::device, "live colors")),
      parents_(Buffer::of<std::uint32_t>(device, live.slots() - live.count(), Memory::device, "parents")),
      changes_(Buffer::of<shared::GivenChange>(device, mostChanges_, Memory::upload, "given changes")) {
  upload(device, brush_, std::vector{sharedBrush(brush, radius)});
  if (!colors.empty()) {
    std::vector<std::uint32_t> byId(live.slots());
    std::ranges::copy(colors, byId.begin());
    upload(device, colors_, byId);
  }
}

void EditPass::recordSelect(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                            const Buffer& contactState, std::optional<std::uint32_t> firstSlot) const {
  const shared::HashUpdateArgs update = update_.args(cloud, parity);
  const std::uint64_t cells = firstSlot ? 0 : boxCells_;
  const std::uint32_t first = firstSlot.value_or(0);
  const std::uint32_t slots = firstSlot ? std::min(update_.mostMoves(), cloud.slots - first) : cloud.slots;
  const std::uint64_t groups = (cells * cells * cells + shared::kSelectCells - 1) / shared::kSelectCells;
  list.dispatch(select_, cells > 0 ? groups * shared::kUpdateWorkgroup : slots,
                shared::SelectArgs{.cloud = cloud,
                                   .update = update.update,
                                   .moves = update.moves,
                                   .marks = update.marks,
                                   .touched = update.touched,
                                   .state = contactState.address(),
                                   .brush = brush_.address(),
                                   .colors = colors(),
                                   .mostMoves = update_.mostMoves(),
                                   .cells = static_cast<std::uint32_t>(cells),
                                   .firstSlot = first,
                                   .slots = slots});
  if (options_.kind != BrushKind::smooth) return;
  list.dispatchIndirect(smooth_, update_.counters(),
                        shared::SmoothArgs{.cloud = cloud,
                                           .update = update.update,
                                           .moves = update.moves,
                                           .marks = update.marks,
                                           .touched = update.touched,
                                           .state = contactState.address(),
                                           .brush = brush_.address(),
                                           .mostMoves = update_.mostMoves(),
                                           .unused = 0},
                        offsetof(shared::HashUpdate, movedGroups));
}

void EditPass::recordIncremental(CommandList& list, const LiveCloud::Side& side, const Buffer& contactState) const {
  const shared::CloudView cloud = view(side);
  update_.recordBegin(list);
  {
    const auto section = list.section("brush");
    recordSelect(list, cloud, side.parity, contactState, std::nullopt);
  }
  update_.recordApply(list, cloud, side.parity);
  if (options_.kind == BrushKind::carve) recordLogGone(list);
  recordRefit(list, cloud);
  update_.recordReport(list);
}

void EditPass::recordRebuild(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                             const Buffer& contactState, SortMethod sort, Reach reach) const {
  {
    const auto section = list.section("brush");
    const bool all = reach == Reach::all || boxCells_ == 0;
    const std::uint32_t atATime = all ? update_.mostMoves() : live_.slots();
    for (std::uint32_t first = 0; first < live_.slots(); first += atATime) {
      update_.recordBegin(list);
      recordSelect(list, view(from), from.parity, contactState, all ? std::optional(first) : std::nullopt);
      update_.recordCommit(list, view(from));
      if (options_.kind == BrushKind::carve) recordLogGone(list);
    }
  }
  hash_.recordBuild(list, from, to, live_.slots(), sort);
  update_.recordRecount(list, view(to), to.parity);
  recordRefit(list, view(to));
  update_.recordReport(list);
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

void EditPass::recordRestore(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity) const {
  const shared::HashUpdateArgs update = update_.args(cloud, parity);
  list.dispatch(restore_, std::uint64_t{given_} * device_.subgroupSize(),
                shared::RestoreArgs{.cloud = cloud,
                                    .update = update.update,
                                    .moves = update.moves,
                                    .marks = update.marks,
                                    .touched = update.touched,
                                    .changes = changes_.address(),
                                    .colors = colors(),
                                    .parents = parents_.address(),
                                    .mostMoves = update_.mostMoves(),
                                    .firstNew = live_.count(),
                                    .count = given_,
                                    .unused = 0});
}

void EditPass::recordGivenIncremental(CommandList& list, const LiveCloud::Side& side) const {
  const shared::CloudView cloud = view(side);
  update_.recordBegin(list);
  recordRestore(list, cloud, side.parity);
  update_.recordApply(list, cloud, side.parity);
  recordLogGone(list);
  recordRefit(list, cloud);
  update_.recordReport(list);
}

void EditPass::recordGivenRebuild(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                                  SortMethod sort) const {
  update_.recordBegin(list);
  recordRestore(list, view(from), from.parity);
  update_.recordCommit(list, view(from));
  recordLogGone(list);
  hash_.recordBuild(list, from, to, live_.slots(), sort);
  update_.recordRecount(list, view(to), to.parity);
  recordRefit(list, view(to));
  update_.recordReport(list);
}

void EditPass::recordCompaction(CommandList& list, const LiveCloud::Side& from, const LiveCloud::Side& to,
                                SortMethod sort) const {
  update_.recordBegin(list);
  hash_.recordBuild(list, from, to, live_.slots(), sort);
  update_.recordRecount(list, view(to), to.parity);
  update_.recordReport(list);
}

void EditPass::recordLogGone(CommandList& list) const {
  const shared::HashUpdateArgs update = update_.args({}, 0);
  list.dispatchIndirect(logGone_, update_.counters(),
                        shared::LogGoneArgs{.update = update.update,
                                            .moves = update.moves,
                                            .entries = log_.entries(),
                                            .head = log_.head(),
                                            .colors = colors(),
                                            .parents = parents_.address(),
                                            .capacityMask = static_cast<std::uint32_t>(log_.capacity() - 1),
                                            .firstNew = live_.count()},
                        offsetof(shared::HashUpdate, moveGroups));
}

void EditPass::recordRefit(CommandList& list, const shared::CloudView& cloud) const {
  const auto section = list.section("refit normals");
  list.dispatchIndirect(refit_, update_.counters(),
                        shared::RefitNormalsArgs{.cloud = cloud,
                                                 .update = update_.counters().address(),
                                                 .changed = update_.changed(),
                                                 .entries = log_.entries(),
                                                 .head = log_.head(),
                                                 .colors = colors(),
                                                 .parents = parents_.address(),
                                                 .capacityMask = static_cast<std::uint32_t>(log_.capacity() - 1),
                                                 .radius = static_cast<float>(radius_),
                                                 .firstNew = live_.count(),
                                                 .unused = 0},
                        offsetof(shared::HashUpdate, changedGroups));
}

void EditPass::complete(std::vector<PointState>& points) const {
  const auto parents = download<std::uint32_t>(device_, parents_, live_.slots() - live_.count());
  const auto byId = download<std::uint32_t>(device_, colors_, colors_.bytes() / sizeof(std::uint32_t));
  for (PointState& point : points) {
    if (point.id >= live_.count()) point.parent = parents[point.id - live_.count()];
    if (!byId.empty()) point.color = byId[point.id];
  }
}

std::uint64_t EditPass::bytes() const {
  return update_.bytes() + brush_.bytes() + colors_.bytes() + parents_.bytes() + changes_.bytes();
}

std::uint64_t EditPass::predictedBytes(std::uint64_t points, bool colors) {
  constexpr std::uint64_t kWord = sizeof(std::uint32_t);
  const std::uint64_t spare = HashUpdate::spareSlots(points);
  const std::uint64_t changes = std::min<std::uint64_t>(kMostChanges, HashUpdate::defaultMoves(points));
  return HashUpdate::predictedBytes(points) + kWord * spare + (colors ? kWord * (points + spare) : 0) +
         changes * sizeof(shared::GivenChange);
}

}  // namespace palpate
