#include "engine/render/splat_index.hpp"

#include <limits>

#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

PipelineOptions followPipeline(const CountedDispatch& dispatch) {
  return {.workgroupSize = shared::kUpdateWorkgroup,
          .pushBytes = sizeof(shared::SplatFollowArgs),
          .constants = {dispatch.countsGroups()}};
}

}  // namespace

SplatIndex::Following::Following(Device& device, const SpatialHash& hash, const HashUpdateOptions& options)
    : update(device, device.throughputQueue(), hash, options),
      follow(device, shader_code::render_splat_follow, followPipeline(update.dispatch())),
      near(device, shader_code::render_splat_near, {.pushBytes = sizeof(shared::SplatNearArgs)}),
      clearMarks(device, shader_code::render_splat_forget, {.pushBytes = sizeof(shared::SplatForgetArgs)}),
      // Room for a vec4 at the end: the validation layer of Debian 12 takes the store of an ivec3 for one.
      cells(device, sizeof(shared::ChangedCells) + sizeof(IVec3) * std::uint64_t{update.mostMoves()} + sizeof(float),
            Memory::device, "changed cells"),
      cellsRead(Buffer::of<shared::ChangedCells>(device, 1, Memory::readback, "read number of changed cells")),
      lastOf(Buffer::of<std::uint32_t>(device, std::uint64_t{hash.grid().bucketMask} + 1, Memory::device,
                                       "last changed cells")),
      lists(Buffer::of<shared::SplatIndexLists>(device, 1, Memory::device, "lists of a splat index")),
      mostCells(update.mostMoves()) {
  cellsRead.mapped<shared::ChangedCells>()[0] = {};
  upload(device, device.throughputQueue(), lists,
         std::vector<shared::SplatIndexLists>{{.moves = update.moves(),
                                               .marks = update.marks(),
                                               .touched = update.touched(),
                                               .movesOf = update.bySlot(),
                                               .capacities = update.args({}, 0).capacities,
                                               .cells = cells.address(),
                                               .lastOf = lastOf.address(),
                                               .mostMoves = update.mostMoves(),
                                               .mostCells = mostCells}});
  CommandList clear(device, device.throughputQueue(), "clear changed cells");
  clear.begin();
  clear.fill(cells, 0, sizeof(shared::ChangedCells));
  clear.fill(lastOf, 0, lastOf.bytes());
  clear.end();
  device.throughputQueue().run(clear);
}

std::uint64_t SplatIndex::Following::bytes() const {
  return update.bytes() + cells.bytes() + cellsRead.bytes() + lastOf.bytes() + lists.bytes();
}

SplatIndex::SplatIndex(Device& device, const HashGrid& grid, std::span<const Vec3> positions, std::uint32_t places,
                       bool follows)
    : device_(device),
      places_(places),
      slots_(places + (follows ? HashUpdate::spareSlots(places) : 0)),
      hash_(device, grid, places, sortInOrder(device, grid, positions, Slots::spare), BucketOrder::stable, Slots::spare,
            &device.throughputQueue()),
      ordered_{Buffer::of<Vec4>(device, slots_, Memory::device, "hashed positions"),
               Buffer::of<Vec4>(device, slots_, Memory::device, "hashed normals"), 0},
      list_(device, device.throughputQueue(), "splat index") {
  if (follows)
    following_.emplace(device, hash_, HashUpdateOptions{.points = places, .slots = slots_, .order = UpdateOrder::ids});
}

void SplatIndex::build(const LiveCloud::Half& points, const std::function<void(CommandList&)>& then) {
  SortMethod sort;
  do {  // again if a bucket was crowded, since the order of its points may then be arbitrary
    sort = hash_.sort();
    list_.begin();
    hash_.recordBuild(list_, points, ordered_, places_, sort);
    if (following_) {
      const std::uint64_t built = sizeof(Vec4) * std::uint64_t{places_};
      list_.fill(ordered_.positions, shared::kEmptySlot, ordered_.positions.bytes() - built, built);
      following_->update.recordRecount(list_, hash_.view(ordered_, places_), ordered_.parity, 0);
      following_->update.recordBegin(list_);
    }
    then(list_);
    list_.end();
    device_.throughputQueue().run(list_);
  } while (sort != hash_.sort());
  isCurrent_ = following_.has_value();
}

void SplatIndex::recordFollow(CommandList& list, const shared::CatchUpArgs& changes) const {
  const HashUpdate& update = following_->update;
  const auto section = list.section("index of discs");
  list.dispatch(following_->follow, changes.entryCount,
                shared::SplatFollowArgs{.cloud = view(),
                                        .update = update.counters().address(),
                                        .lists = following_->lists.address(),
                                        .entries = changes.entries,
                                        .latest = changes.latest,
                                        .positions = changes.positions,
                                        .normals = changes.normals,
                                        .firstSlot = changes.firstSlot,
                                        .slotMask = changes.slotMask,
                                        .entryCount = changes.entryCount,
                                        .pointCount = changes.pointCount,
                                        .listedBefore = following_->listedBefore,
                                        .unused = 0});
  update.recordApply(list, view(), ordered_.parity);
  update.recordEnd(list);
  list.copy(following_->cells, following_->cellsRead, sizeof(shared::ChangedCells));
}

void SplatIndex::readFollowed() {
  if (following_->update.report().failed != 0) isCurrent_ = false;
}

std::optional<std::uint32_t> SplatIndex::changedCells() const {
  if (changes().everywhere != 0) return std::nullopt;
  return changes().count;
}

void SplatIndex::recordNear(CommandList& list, shared::SplatNearArgs args) const {
  args.cloud = view();
  args.cells = following_->cells.address();
  args.lastOf = following_->lastOf.address();
  args.listed = changes().count;
  args.listedBefore = following_->listedBefore;
  list.dispatch(following_->near, std::uint64_t{shared::kSplatNearLayers} * args.listed * device_.subgroupSize(), args);
  list.copy(following_->cells, following_->cellsRead, sizeof(shared::ChangedCells));
}

void SplatIndex::recordForget(CommandList& list) const {
  if (!following_) return;
  list.fill(following_->cells, 0, sizeof(shared::ChangedCells));
  if (restarts()) list.fill(following_->lastOf, 0, following_->lastOf.bytes());
}

void SplatIndex::recordClearMarks(CommandList& list, const Buffer& marks) const {
  const std::uint32_t listed = changes().count;
  if (listed == 0) return;
  list.dispatch(following_->clearMarks, listed,
                shared::SplatForgetArgs{.cells = following_->cells.address(),
                                        .changed = marks.address(),
                                        .grid = grid(),
                                        .listed = listed,
                                        .unused = 0});
}

// Whether the numbers of cells begin again at 0: they may have outgrown a word, or the list.
bool SplatIndex::restarts() const {
  return changes().everywhere != 0 || following_->listedBefore > std::numeric_limits<std::uint32_t>::max() / 2;
}

void SplatIndex::forget() {
  if (!following_) return;
  following_->listedBefore = restarts() ? 0 : following_->listedBefore + changes().count;
  following_->cellsRead.mapped<shared::ChangedCells>()[0] = {};
}

std::uint64_t SplatIndex::bytes() const {
  return hash_.bytes() + ordered_.positions.bytes() + ordered_.normals.bytes() + (following_ ? following_->bytes() : 0);
}

}  // namespace palpate
