// A cloud on the GPU with everything that edits it, and a mirror of it on the host that follows the log alone.
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

  /// One tick of the brush for a contact state that we choose; false when the update was not carried out.
  bool brush(const DVec3& hip, const DVec3& spring, How how, const DVec3& motion = DVec3(0));
  /// Changes as they are given; false when they were not carried out.
  bool change(std::span<const PointChange> changes, How how);
  /// A full build and nothing else.
  void compact();
  /// Goes on with a compaction in the background, begins it where none is under way, by so many steps: the first notes
  /// what changes, each of the next is a slice, and the last makes an end to it. True when that one came out.
  bool compactFurther(std::uint32_t steps);
  HashCompaction& compaction() { return *compaction_; }

  /// What the log said since the last call.
  std::vector<PointState> takeLog();
  /// All points of the GPU by id.
  std::map<std::uint32_t, PointState> points() const;
  /// How many things are wrong with the index: a bucket that misses one of its points or has another's, a range that
  /// overlaps a second one or reads an empty slot, a point that no bucket has or two have, a mark left behind.
  std::size_t faults() const;
  /// Every bucket's ids in order.
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
