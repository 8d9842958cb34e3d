#pragma once

#include <functional>
#include <optional>

#include "engine/core/clock.hpp"
#include "engine/spatial/hash_compaction.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "engine/touch/touch_backend.hpp"

namespace palpate {

struct LiveIndexOptions {
  HashGrid grid;
  std::uint32_t spareSlots = 0;  ///< for points added by edits or frames
  SortMethod sort = kDefaultSort;
  BucketOrder bucketOrder = BucketOrder::stable;
  Slots slots = Slots::full;
  bool colored = false;  ///< points have colours (LiveCloud)
};

/// Results of index compactions in the background.
struct CompactionRecord {
  std::uint64_t completed = 0;
  /// Longest time that touch waited for the end of a compaction, us: its GPU time; without GPU timing, the time from
  /// the question queued behind it until that question's answer was seen.
  double longestEnd_us = 0;
};

/// The live cloud and its index, double-buffered: full builds, and the compaction of an index that follows edits.
class LiveIndex {
 public:
  /// Uploads the cloud and builds its index.
  LiveIndex(Device& device, const PointCloud& cloud, const LiveIndexOptions& options);

  const LiveCloud& cloud() const { return live_; }
  const SpatialHash& hash() const { return hash_; }
  /// View of the front half.
  shared::CloudView view() const { return hash_.view(live_.front(), live_.slots()); }
  std::uint32_t parity() const { return live_.parity(); }
  /// Makes the other half the front.
  void flip() { live_.flip(); }

  /// From now on edits change the index by `update`, which must outlive it, and compactions run in the background.
  void follow(const HashUpdate& update, const CompactionOptions& options);
  /// Outcome of the last completed edit: the index followed it (followed()), or was rebuilt for it and the cloud
  /// flipped (built()).
  void followed() { ++work_.followed; }
  void built();
  /// Reads from the last completed edit's report whether a compaction is due.
  void readReport();

  /// Runs the next step of the background compaction, if it is due or running; in virtual time the whole compaction.
  void compactFurther(bool realtime);
  /// Finishes a compaction whose last list the GPU has run. `sinceAsked`: time since the question queued behind it, if
  /// the driver is not asked for times; otherwise null.
  void collectCompaction(const Stopwatch* sinceAsked);
  /// Whether a full build may write the other half of the cloud now. Abandons a compaction for it; in real time the
  /// caller must retry while a slice of it is running.
  bool mayBuild(bool realtime);
  /// Records, with the sort that a build needs, a list that reads one half of the cloud and writes the other; runs it
  /// and flips.
  void buildNow(const std::function<void(CommandList&, SortMethod)>& record);

  bool isCompacting() const { return compaction_ && !compaction_->isIdle(); }
  const CompactionRecord& compactions() const { return compactions_; }
  const IndexWork& work() const { return work_; }
  /// Time of the first build, us.
  double buildTime_us() const { return buildTime_us_; }

 private:
  void noteCompaction(bool completed, const Stopwatch* sinceAsked);

  Device& device_;
  LiveCloud live_;
  SpatialHash hash_;
  const HashUpdate* update_ = nullptr;        // if the index follows edits
  std::optional<HashCompaction> compaction_;  // with update_
  bool compactionDue_ = false;
  CompactionRecord compactions_;
  IndexWork work_;
  double buildTime_us_;
};

}  // namespace palpate
