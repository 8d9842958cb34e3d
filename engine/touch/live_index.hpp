#pragma once

#include <functional>
#include <optional>

#include "engine/core/clock.hpp"
#include "engine/core/touch_backend.hpp"
#include "engine/spatial/hash_compaction.hpp"
#include "engine/spatial/spatial_hash.hpp"

namespace palpate {

struct LiveIndexOptions {
  HashGrid grid;
  std::uint32_t spareSlots = 0;  ///< where points may come and go
  SortMethod sort = kDefaultSort;
  BucketOrder bucketOrder = BucketOrder::stable;
  Slots slots = Slots::full;
  bool colored = false;  ///< the points carry their colours (LiveCloud)
};

/// What came of bringing the index together again in the background.
struct CompactionRecord {
  std::uint64_t completed = 0;
  /// The longest time that touch had to wait for the end of one, us: its time on the GPU; where a driver is not asked
  /// for times, that of the question which stood behind it, from then until its answer was seen.
  double longestEnd_us = 0;
};

/// The live cloud and its index, double-buffered: full builds, and the compaction that brings an index which follows
/// edits together again.
class LiveIndex {
 public:
  /// Uploads the cloud and builds its index.
  LiveIndex(Device& device, const PointCloud& cloud, const LiveIndexOptions& options);

  const LiveCloud& cloud() const { return live_; }
  const SpatialHash& hash() const { return hash_; }
  /// Of the half that counts.
  shared::CloudView view() const { return hash_.view(live_.front(), live_.slots()); }
  std::uint32_t parity() const { return live_.parity(); }
  /// The other half counts from now on.
  void flip() { live_.flip(); }

  /// From now on edits change it by `update`, which must outlive it, and compactions run in the background.
  void follow(const HashUpdate& update, const CompactionOptions& options);
  /// Of the edit that has completed last: the index has followed it, or was built anew for it with the cloud flipped.
  void followed() { ++work_.followed; }
  void built();
  /// From the report of the edit that has completed last: whether a compaction is due.
  void readReport();

  /// Compaction in the background: the next step of it, if it is due or under way; in virtual time all of it at once.
  void compactFurther(bool realtime);
  /// Makes an end to a compaction whose last list the GPU has run. `sinceAsked`: of the question that stood behind it,
  /// where the driver is not asked for times; null where it is.
  void collectCompaction(const Stopwatch* sinceAsked);
  /// Whether a full build may write the other half of the cloud now: a compaction is given up for it, and in real time
  /// it must come again while a slice is under way.
  bool mayBuild(bool realtime);
  /// Records, with the sort that a build needs, what reads one half of the cloud and writes the other; runs and flips.
  void buildNow(const std::function<void(CommandList&, SortMethod)>& record);

  bool isCompacting() const { return compaction_ && !compaction_->isIdle(); }
  const CompactionRecord& compactions() const { return compactions_; }
  const IndexWork& work() const { return work_; }
  /// Of the first build, us.
  double buildTime_us() const { return buildTime_us_; }

 private:
  void noteCompaction(bool completed, const Stopwatch* sinceAsked);

  Device& device_;
  LiveCloud live_;
  SpatialHash hash_;
  const HashUpdate* update_ = nullptr;        // where the index follows edits
  std::optional<HashCompaction> compaction_;  // there, too
  bool compactionDue_ = false;
  CompactionRecord compactions_;
  IndexWork work_;
  double buildTime_us_;
};

}  // namespace palpate
