#include "engine/spatial/hash_update.hpp"

#include <algorithm>

#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

// Shares of the points: spare slots, and moves of one update. More slots postpone compactions, more moves raise the
// size from which an edit rebuilds; both cost memory.
constexpr std::uint64_t kSpareShare = 10, kMovesShare = 16;
constexpr std::uint64_t kMinSpare = 1 << 14, kMinMoves = 1 << 14;
// Buckets that may change during a compaction, per move of an update.
constexpr std::uint64_t kDirtyPerMove = 4;

constexpr std::uint64_t kBucketsPerMove = 2;   // maximum number of buckets that a move touches
constexpr std::uint64_t kWordsPerArrival = 2;  // stored after the list of those buckets
constexpr std::uint64_t kBytesPerMove =
    sizeof(shared::PointMove) + (kBucketsPerMove + kWordsPerArrival + 1) * sizeof(std::uint32_t) + sizeof(Vec4);

PipelineOptions pipeline(std::uint32_t pushBytes, const CountedDispatch& dispatch) {
  return {.workgroupSize = shared::kUpdateWorkgroup, .pushBytes = pushBytes, .constants = {dispatch.countsGroups()}};
}

PipelineOptions applyPipeline(const CountedDispatch& dispatch, UpdateOrder order) {
  PipelineOptions options = pipeline(sizeof(shared::HashUpdateArgs), dispatch);
  options.constants.push_back(order == UpdateOrder::ids ? 1 : 0);
  return options;
}

// Length of the list of dirty buckets, which contains each once.
std::uint32_t dirtyListFor(std::uint64_t moves, std::uint64_t buckets) {
  return static_cast<std::uint32_t>(std::min(kDirtyPerMove * moves, buckets));
}

// Words for the capacity of the list, the map, and the list.
std::uint64_t dirtyWords(std::uint64_t moves, const HashGrid& grid) {
  return 1 + std::uint64_t{shared::dirtyListFrom(grid)} + dirtyListFor(moves, std::uint64_t{grid.bucketMask} + 1);
}

}  // namespace

std::uint32_t HashUpdate::spareSlots(std::uint64_t points) {
  return static_cast<std::uint32_t>(std::max(kMinSpare, points / kSpareShare));
}

std::uint32_t HashUpdate::defaultMoves(std::uint64_t points) {
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(points / kMovesShare, kMinMoves, shared::kMarkMove));
}

HashUpdate::HashUpdate(Device& device, Queue& queue, const SpatialHash& hash, const HashUpdateOptions& options)
    : mostMoves_(defaultMoves(options.points)),
      mostDirty_(dirtyListFor(mostMoves_, std::uint64_t{hash.grid().bucketMask} + 1)),
      dispatch_(device),
      apply_(device, shader_code::spatial_update_apply, applyPipeline(dispatch_, options.order)),
      commit_(device, shader_code::spatial_update_commit, pipeline(sizeof(shared::HashUpdateArgs), dispatch_)),
      recount_(device, shader_code::spatial_update_recount, pipeline(sizeof(shared::HashRecountArgs), dispatch_)),
      template_(Buffer::of<shared::HashUpdate>(device, 1, Memory::device, "empty update")),
      counters_(Buffer::of<shared::HashUpdate>(device, 1, Memory::device, "update counters")),
      report_(Buffer::of<shared::HashUpdate>(device, 1, Memory::readback, "update report")),
      // One more, since the validation layer of Debian 12 overestimates the size of the store of a whole move.
      moves_(Buffer::of<shared::PointMove>(device, std::uint64_t{mostMoves_} + 1, Memory::device, "point moves")),
      marks_(deviceWords(device, hash.grid().bucketMask + 1, "bucket marks")),
      touched_(
          deviceWords(device, (kBucketsPerMove + kWordsPerArrival) * std::uint64_t{mostMoves_}, "touched buckets")),
      fitted_(Buffer::of<Vec4>(device, mostMoves_, Memory::device, "fitted normals")),
      changed_(deviceWords(device, mostMoves_, "changed slots")),
      bySlot_(deviceWords(device, options.slots, "moves of slots")),
      dirty_(deviceWords(device, dirtyWords(mostMoves_, hash.grid()), "dirty buckets")),
      capacities_{deviceWords(device, hash.grid().bucketMask + 1, "bucket capacities"),
                  deviceWords(device, hash.grid().bucketMask + 1, "bucket capacities")} {
  const UVec3 none(0, 1, 1);
  const shared::HashUpdate begin{.moveGroups = none,
                                 .movedGroups = none,
                                 .applyGroups = none,
                                 .changedGroups = UVec3(1),
                                 .head = options.points,
                                 .points = options.points,
                                 .nearest = shared::kOutsideSheet};
  upload(device, queue, template_, std::vector{begin});
  upload(device, queue, counters_, std::vector{begin});
  report_.mapped<shared::HashUpdate>()[0] = begin;
  CommandList clear(device, queue, "clear update");
  clear.begin();
  clear.fill(marks_, 0, marks_.bytes());
  clear.fill(dirty_, 0, dirty_.bytes());
  for (const Buffer& capacities : capacities_) clear.fill(capacities, 0, capacities.bytes());
  clear.end();
  queue.run(clear);
}

shared::HashUpdateArgs HashUpdate::args(const shared::CloudView& cloud, std::uint32_t parity) const {
  return {.cloud = cloud,
          .update = counters_.address(),
          .moves = moves_.address(),
          .marks = marks_.address(),
          .touched = touched_.address(),
          .movesOf = bySlot_.address(),
          .capacities = capacities_[parity].address(),
          .changed = changed_.address(),
          .dirty = dirty_.address(),
          .mostMoves = mostMoves_,
          .unused = 0};
}

void HashUpdate::recordBegin(CommandList& list) const { list.copy(template_, counters_, shared::kUpdateBegins); }

void HashUpdate::recordApply(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity) const {
  const auto section = list.section("index update");
  const shared::HashUpdateArgs io = args(cloud, parity);
  dispatch_(list, apply_, CountedDispatch::Step::bucket, counters_, offsetof(shared::HashUpdate, applyGroups), io);
}

void HashUpdate::recordCommit(CommandList& list, const shared::CloudView& cloud) const {
  dispatch_(list, commit_, CountedDispatch::Step::invocation, counters_, offsetof(shared::HashUpdate, moveGroups),
            args(cloud, 0));
}

void HashUpdate::recordRecount(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                               DeviceAddress changed) const {
  list.fill(capacities_[parity], 0, capacities_[parity].bytes());
  list.dispatch(recount_, changed ? cloud.slots : 1,
                shared::HashRecountArgs{.cloud = cloud, .update = counters_.address(), .changed = changed});
}

void HashUpdate::recordNoting(CommandList& list, std::uint32_t most) const {
  constexpr std::uint64_t kWord = sizeof(std::uint32_t);
  const auto overlap = list.independent();
  list.fill(counters_, 1, kWord, offsetof(shared::HashUpdate, compacting));
  list.fill(counters_, 0, kWord, offsetof(shared::HashUpdate, dirty));
  list.fill(dirty_, std::min(most, mostDirty_), kWord);
  list.fill(dirty_, 0, dirty_.bytes() - kWord * (1 + std::uint64_t{mostDirty_}), kWord);
}

void HashUpdate::recordEnd(CommandList& list) const {
  list.copy(counters_, report_, sizeof(shared::HashUpdate));
  recordBegin(list);
}

void HashUpdate::recordReport(CommandList& list) const {
  list.copy(counters_, report_, sizeof(shared::HashUpdate) - shared::kUpdateBegins, shared::kUpdateBegins,
            shared::kUpdateBegins);
}

std::uint64_t HashUpdate::bytes() const {
  return template_.bytes() + counters_.bytes() + report_.bytes() + moves_.bytes() + marks_.bytes() + touched_.bytes() +
         fitted_.bytes() + changed_.bytes() + bySlot_.bytes() + dirty_.bytes() + 2 * capacities_[0].bytes();
}

std::uint64_t HashUpdate::predictedBytes(std::uint64_t points) {
  const HashGrid grid = makeHashGrid(Vec3(0), 1, points);
  const std::uint64_t buckets = std::uint64_t{grid.bucketMask} + 1;
  constexpr std::uint64_t kWord = sizeof(std::uint32_t), kArraysByBucket = 3;
  return defaultMoves(points) * kBytesPerMove + dirtyWords(defaultMoves(points), grid) * kWord +
         (points + spareSlots(points)) * kWord + kArraysByBucket * kWord * buckets;
}

}  // namespace palpate
