#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "engine/gpu/command_list.hpp"
#include "engine/spatial/hash_update.hpp"
#include "shaders/shared/hash_compaction.h"

namespace palpate {

/// The submissions of a HashCompaction: its passes, recorded ahead for both halves of the live cloud, and their working
/// memory.
class CompactionLists {
 public:
  /// All arguments must outlive it. Waits until its passes have run once without work. `bucketsEach`: of a slice;
  /// `mostDirty`: maximum number of buckets that change during a compaction.
  CompactionLists(Device& device, const SpatialHash& hash, const LiveCloud& live, const HashUpdate& update,
                  std::uint32_t bucketsEach, std::uint32_t mostDirty);

  // `parity`: of the half that is copied.
  /// For the latency queue: starts noting the buckets that edits change.
  const CommandList& begin(std::uint32_t parity) const { return *begin_[parity]; }
  /// For the background queue: processes the given slice.
  const CommandList& slice(std::uint32_t parity, const shared::CompactionSlice& slice) const {
    sliceOf_.mapped<shared::CompactionSlice>()[0] = slice;
    return *slice_[parity];
  }
  /// For the latency queue: copies changed buckets again and writes the report.
  const CommandList& end(std::uint32_t parity) const { return *end_[parity]; }

  /// Report of the last end().
  const shared::HashCompaction& report() const { return report_.mapped<const shared::HashCompaction>()[0]; }
  double sliceTime_us(std::uint32_t parity) const { return slice_[parity]->sectionTime_us("compaction"); }
  double endTime_us(std::uint32_t parity) const { return end_[parity]->sectionTime_us("compaction"); }
  std::uint64_t bytes() const { return state_.bytes() + report_.bytes() + sliceOf_.bytes(); }

 private:
  struct Sources {
    const SpatialHash& hash;
    const LiveCloud& live;
    const HashUpdate& update;
    std::uint32_t bucketsEach, mostDirty;
  };
  void record(const Sources& sources, const LiveCloud::Half& from, const LiveCloud::Half& to);
  void warmUp(std::uint32_t parity);

  Device& device_;
  ComputePipeline slicePass_, plan_, again_, finish_;
  Buffer state_, report_, sliceOf_;
  // By the parity of the front half.
  std::array<std::unique_ptr<CommandList>, 2> begin_, slice_, end_;
};

}  // namespace palpate
