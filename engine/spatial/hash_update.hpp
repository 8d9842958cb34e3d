#pragma once

#include <array>
#include <cstdint>

#include "engine/spatial/counted_dispatch.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "shaders/shared/hash_update.h"

namespace palpate {

/// Brings a SpatialHash up to date after an edit that touched k points, at a cost that grows with k alone. Whoever
/// edits fills the list of moves between recordBegin() and recordApply(), which carries all of them out or none.
///
/// A bucket keeps its points in consecutive slots, as a build leaves them; one that outgrows its slots moves to the end
/// of the cloud's slots, which must have some to spare. Within a bucket points stand in an order that depends on the
/// edits alone, not on the GPU's timing: those that stayed, then those that came, by their ids.
class HashUpdate {
 public:
  /// `live`: as `hash` is going to build it first, without gaps.
  HashUpdate(Device& device, const SpatialHash& hash, const LiveCloud& live);

  /// Slots to spare for a cloud of so many points, and moves that one update of it may hold.
  static std::uint32_t spareSlots(std::uint64_t points);
  static std::uint32_t defaultMoves(std::uint64_t points);

  /// Empties the lists, where one update follows another without an end between them.
  void recordBegin(CommandList& list) const;
  /// Carries the listed moves out in the index of one half of the cloud.
  void recordApply(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity) const;
  /// Writes them where the points stand, for a full build to follow: of this half, whose index then no longer holds.
  void recordCommit(CommandList& list, const shared::CloudView& cloud) const;
  /// After a full build that has written `cloud`: lists what changed, and which slots are free.
  /// `changed`: room for a word for every slot.
  void recordRecount(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                     DeviceAddress changed) const;

  /// From here on buckets that change are noted, up to `most` of them, each once: until recordRecount(), or a
  /// HashCompaction that has come to its end.
  void recordNoting(CommandList& list, std::uint32_t most) const;

  std::uint32_t mostMoves() const { return mostMoves_; }
  std::uint32_t mostDirty() const { return mostDirty_; }
  /// A HashUpdate of shaders/shared/hash_update.h.
  const Buffer& counters() const { return counters_; }
  /// What passes that list moves need.
  shared::HashUpdateArgs args(const shared::CloudView& cloud, std::uint32_t parity) const;
  DeviceAddress moves() const { return moves_.address(); }
  DeviceAddress marks() const { return marks_.address(); }
  DeviceAddress changed() const { return changed_.address(); }
  DeviceAddress touched() const { return touched_.address(); }
  /// A word for each slot of the cloud, free once recordApply() has done its work.
  DeviceAddress bySlot() const { return bySlot_.address(); }
  /// Room for a vec4 for every slot that recordApply() lists.
  DeviceAddress fitted() const { return fitted_.address(); }

  /// How passes over its lists are dispatched.
  const CountedDispatch& dispatch() const { return dispatch_; }
  /// Reports the update to the host and empties the lists, which the next one counts on. The last pass of an edit does
  /// the same by itself: it copies counters() to reportAddress(), and emptyCounters() over their first part.
  void recordEnd(CommandList& list) const;
  DeviceAddress reportAddress() const { return report_.address(); }
  DeviceAddress emptyCounters() const { return template_.address(); }
  /// Reports to the host again what counts beyond one update: points and slots.
  void recordReport(CommandList& list) const;
  /// Of the last update that has completed.
  const shared::HashUpdate& report() const { return report_.mapped<const shared::HashUpdate>()[0]; }

  std::uint64_t bytes() const;
  /// Predicts bytes() for a cloud that is not there yet.
  static std::uint64_t predictedBytes(std::uint64_t points);

 private:
  std::uint32_t mostMoves_, mostDirty_;
  CountedDispatch dispatch_;
  ComputePipeline apply_, commit_, recount_;
  Buffer template_, counters_, report_, moves_, marks_, touched_, fitted_, changed_, bySlot_, dirty_;
  std::array<Buffer, 2> capacities_;
};

}  // namespace palpate
