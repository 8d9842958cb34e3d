#pragma once

#include <functional>
#include <optional>

#include "engine/gpu/command_list.hpp"
#include "engine/spatial/hash_update.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "shaders/shared/drawn_cloud.h"
#include "shaders/shared/splat_index.h"
#include "shaders/shared/splat_radius.h"

namespace palpate {

/// The sight side's index of the drawn points: a spatial hash over a copy of them, since the drawn cloud is in the
/// order of the file. It follows edits at a cost of the touched points, as long as its spare slots last and an edit is
/// small; then it must be built again. Works on the throughput queue.
class SplatIndex {
 public:
  /// `positions`: in the order of their ids. `follows`: with the memory to follow edits.
  SplatIndex(Device& device, const HashGrid& grid, std::span<const Vec3> positions, std::uint32_t places, bool follows);

  /// Builds the whole index, records `then` in the same list, and waits. `points`: in the order of their ids, with ids
  /// in the w of their positions.
  void build(const LiveCloud::Half& points, const std::function<void(CommandList&)>& then);

  /// Whether it contains the present points. Otherwise it must be built.
  bool isCurrent() const { return isCurrent_; }
  /// Points change in a way that it does not follow.
  void lose() { isCurrent_ = false; }
  /// Records how it follows changes that are claimed but not applied yet. Requires isCurrent().
  void recordFollow(CommandList& list, const shared::CatchUpArgs& changes) const;
  /// After that list has run.
  void readFollowed();

  /// Number of cells that edits have changed since the last forget(), or more; empty if they may have affected discs
  /// everywhere. Requires isCurrent().
  std::optional<std::uint32_t> changedCells() const;
  /// Records the pass that lists the discs near those cells. `args`: with its list and the measured reaches. It may
  /// find that changedCells() is empty.
  void recordNear(CommandList& list, shared::SplatNearArgs args) const;
  /// Records that discs are measured as the points are now; once that list has run, call forget().
  void recordForget(CommandList& list) const;
  /// Records that marks are cleared (SplatRadii::changed()): those of changedCells() alone. Before recordForget().
  void recordClearMarks(CommandList& list, const Buffer& marks) const;
  void forget();

  /// The copy of the points, and the first and one-past-last slot of every bucket in it, where points are in the order
  /// of their ids.
  const LiveCloud::Half& ordered() const { return ordered_; }
  const Buffer& ranges() const { return hash_.ranges(ordered_); }
  shared::CloudView view() const { return hash_.view(ordered_, slots_); }
  const HashGrid& grid() const { return hash_.grid(); }
  std::uint64_t bytes() const;

 private:
  struct Following {
    Following(Device& device, const SpatialHash& hash, const HashUpdateOptions& options);
    std::uint64_t bytes() const;

    HashUpdate update;
    ComputePipeline follow, near, clearMarks;
    Buffer cells, cellsRead;  // ChangedCells and the list after it
    Buffer lastOf, lists;
    std::uint32_t mostCells;
    std::uint32_t listedBefore = 0;  // SplatFollowArgs
  };
  bool restarts() const;
  const shared::ChangedCells& changes() const { return following_->cellsRead.mapped<const shared::ChangedCells>()[0]; }

  Device& device_;
  std::uint32_t places_, slots_;
  SpatialHash hash_;
  LiveCloud::Half ordered_;
  std::optional<Following> following_;
  CommandList list_;
  bool isCurrent_ = false;
};

}  // namespace palpate
