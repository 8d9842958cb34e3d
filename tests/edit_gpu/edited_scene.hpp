// A cloud on the GPU with everything that edits it, for comparison with a mirror on the host that follows the log.
#pragma once

#include <functional>
#include <map>

#include "engine/edit/edit_pass.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/spatial/hash_compaction.hpp"

namespace palpate {

class EditedScene {
 public:
  enum class How { incremental, rebuild, rebuildAll };

  EditedScene(Device& device, const PointCloud& cloud, const HashGrid& grid, double radius, const BrushOptions& brush,
              std::span<const std::uint32_t> colors = {}, SortMethod sort = kDefaultSort,
              std::optional<std::uint32_t> spare = std::nullopt, const CompactionOptions& compaction = {});

  /// One tick of the brush for a given contact state; false if the update was refused.
  bool brush(const DVec3& hip, const DVec3& spring, How how, const DVec3& motion = DVec3(0));
  /// Applies the given changes; false if they were refused.
  bool change(std::span<const PointChange> changes, How how);
  /// A full build without an edit.
  void compact();
  /// Advances the background compaction by `steps`, and begins one if idle: the first step starts the recording of
  /// changes, each next step copies a slice, the last ends the compaction. True if it ended with success.
  bool compactFurther(std::uint32_t steps);
  HashCompaction& compaction() { return *compaction_; }

  /// Entries of the log since the last call.
  std::vector<PointState> takeLog();
  /// All points of the GPU by id.
  std::map<std::uint32_t, PointState> points() const;
  /// Number of errors in the index: a point missing from its bucket, in a wrong one or in two; an overlapping range; an
  /// empty slot in a range; a leftover mark.
  std::size_t faults() const;
  /// The ids of every bucket, in order.
  std::map<std::uint32_t, std::vector<std::uint32_t>> buckets() const;
  const shared::HashUpdate& report() const { return edit_->report(); }
  const EditPass& edit() const { return *edit_; }
  const HashCompaction& compaction() const { return *compaction_; }
  const SpatialHash& hash() const { return hash_; }
  const LiveCloud& live() const { return live_; }

 private:
  bool run(How how, const std::function<void(CommandList&)>& record);

  Device& device_;
  LiveCloud live_;
  SpatialHash hash_;
  EditLog log_;
  double radius_;
  std::uint32_t logSeen_ = 0;
  std::optional<EditPass> edit_;
  std::optional<HashCompaction> compaction_;
};

}  // namespace palpate
