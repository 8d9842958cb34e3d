#pragma once

#include <array>
#include <cstdint>

#include "engine/spatial/counted_dispatch.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "shaders/shared/hash_update.h"

namespace palpate {

/// The order of points within a bucket after an update. `arrival`: remaining points first, then added ones by their
/// ids. `ids`: as a stable build of points in the order of their ids leaves them; changed slots are then not listed.
enum class UpdateOrder { arrival, ids };

struct HashUpdateOptions {
  std::uint32_t points = 0;  ///< of the cloud as loaded
  std::uint32_t slots = 0;
  UpdateOrder order = UpdateOrder::arrival;
};

/// Updates a SpatialHash after an edit of k points, at a cost that depends on k alone. The editing pass fills the list
/// of moves between recordBegin() and recordApply(), which carries out all of them or none.
///
/// A bucket keeps its points in consecutive slots, as a build leaves them; if it outgrows them it moves to the end of
/// the cloud's slots, which needs spare ones. The order of points within a bucket depends on the edits alone, not on
/// the GPU's timing.
class HashUpdate {
 public:
  /// For the live cloud as `hash` will build it first, without gaps. `queue`: on which its lists are cleared
  /// immediately.
  HashUpdate(Device& device, Queue& queue, const SpatialHash& hash, const HashUpdateOptions& options);

  /// Spare slots for a cloud of `points` points, and the maximum number of moves in one update of it.
  static std::uint32_t spareSlots(std::uint64_t points);
  static std::uint32_t defaultMoves(std::uint64_t points);

  /// Clears the lists, if one update follows another without an end between them.
  void recordBegin(CommandList& list) const;
  /// Carries out the listed moves in the index of one half of the cloud.
  void recordApply(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity) const;
  /// Writes the moves to the points' current slots, before a rebuild: the index of this half becomes invalid.
  void recordCommit(CommandList& list, const shared::CloudView& cloud) const;
  /// After a rebuild that has written `cloud`: lists the changed slots and the free slots. `changed`: room for a word
  /// for every slot; 0: changed slots are not listed.
  void recordRecount(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                     DeviceAddress changed) const;

  /// From here on changed buckets are noted, up to `most` of them, each once: until recordRecount(), or the end of a
  /// HashCompaction.
  void recordNoting(CommandList& list, std::uint32_t most) const;

  std::uint32_t mostMoves() const { return mostMoves_; }
  std::uint32_t mostDirty() const { return mostDirty_; }
  /// A HashUpdate of shaders/shared/hash_update.h.
  const Buffer& counters() const { return counters_; }
  /// Arguments for passes that list moves.
  shared::HashUpdateArgs args(const shared::CloudView& cloud, std::uint32_t parity) const;
  DeviceAddress moves() const { return moves_.address(); }
  DeviceAddress marks() const { return marks_.address(); }
  DeviceAddress changed() const { return changed_.address(); }
  DeviceAddress touched() const { return touched_.address(); }
  /// A word for each slot of the cloud, unused after recordApply().
  DeviceAddress bySlot() const { return bySlot_.address(); }
  /// Room for a vec4 for every slot listed by recordApply().
  DeviceAddress fitted() const { return fitted_.address(); }

  /// Dispatches passes over its lists.
  const CountedDispatch& dispatch() const { return dispatch_; }
  /// Reports the update to the host and clears the lists, as the next update requires. Alternatively the last pass of
  /// an edit copies counters() to reportAddress(), and emptyCounters() over their first part.
  void recordEnd(CommandList& list) const;
  DeviceAddress reportAddress() const { return report_.address(); }
  DeviceAddress emptyCounters() const { return template_.address(); }
  /// Reports again the values that outlast an update: points and slots.
  void recordReport(CommandList& list) const;
  /// Report of the last completed update.
  const shared::HashUpdate& report() const { return report_.mapped<const shared::HashUpdate>()[0]; }

  std::uint64_t bytes() const;
  /// Predicts bytes() for a cloud that does not exist yet.
  static std::uint64_t predictedBytes(std::uint64_t points);

 private:
  std::uint32_t mostMoves_, mostDirty_;
  CountedDispatch dispatch_;
  ComputePipeline apply_, commit_, recount_;
  Buffer template_, counters_, report_, moves_, marks_, touched_, fitted_, changed_, bySlot_, dirty_;
  std::array<Buffer, 2> capacities_;
};

}  // namespace palpate
