#pragma once

#include <cstdint>

#include "engine/gpu/queue.hpp"
#include "engine/spatial/compaction_lists.hpp"
#include "engine/spatial/compaction_slices.hpp"
#include "engine/spatial/hash_update.hpp"

namespace palpate {

struct CompactionOptions {
  /// Per submission; 0: many if the background has its own queue, few if it delays the touch side.
  std::uint32_t bucketsPerSlice = 0;
  /// Maximum number of buckets that may change during a compaction; limited by the capacity of HashUpdate.
  std::uint32_t mostDirty = ~0u;
};

/// Compacts the points of an index after incremental edits, in the back half of the live cloud, while edits and queries
/// continue in the front half. One call at a time, by the thread that edits; calls block only where stated, and never
/// allocate or record. The order of points within a bucket is kept.
///
/// Stages: idle, begin(), noting, advance(), copying, advance(), …, copied, end(), ending, collect(), idle. During
/// copying nothing else may write the back half; call abandon() first.
class HashCompaction {
 public:
  enum class Stage { idle, noting, copying, abandoning, copied, ending };

  /// All arguments must outlive it. Waits until its passes have run once without work.
  HashCompaction(Device& device, const SpatialHash& hash, const LiveCloud& live, const HashUpdate& update,
                 const CompactionOptions& options = {});
  /// Waits for submitted work, unless the device is lost.
  ~HashCompaction();
  HashCompaction(const HashCompaction&) = delete;
  HashCompaction& operator=(const HashCompaction&) = delete;

  Stage stage() const { return stage_; }
  /// Whether more than half of the slots that were free after the last compaction are used, and enough of them can be
  /// reclaimed; from the report of a completed edit.
  bool isDue(const shared::HashUpdate& report);

  /// Requires idle. Submits to the latency queue: from there on edits note the buckets that they change.
  void begin();
  /// Submits the next slice to the background queue if the previous submission has completed. Also completes
  /// abandoning.
  void advance();
  /// Requires copied. Submits to the latency queue after the last edit: copies the changed buckets again.
  void end();
  /// Requires ending; called after the list of end() has completed, and before any other edit is submitted. True: the
  /// caller must flip the live cloud. False: the compaction failed, without any effect.
  bool collect();
  /// Ticket of the list that end() submitted.
  Queue::Ticket endTicket() const { return ticket_; }

  /// Abandons the compaction. Submitted work continues; isIdle() after advance() tells when it has ended. Not during
  /// ending.
  void abandon();
  bool isIdle() const { return stage_ == Stage::idle; }
  /// Abandons the compaction and waits for submitted work.
  void settle();
  /// Runs a whole compaction and waits; returns as collect().
  bool run();

  std::uint32_t slices() const { return slices_.count(); }
  /// Report of the last end().
  const shared::HashCompaction& report() const { return lists_.report(); }
  /// GPU times of the last slice and of the last list of end(), us: the touch side waits for the latter.
  double sliceTime_us() const { return lists_.sliceTime_us(parity_); }
  double endTime_us() const { return lists_.endTime_us(parity_); }
  std::uint64_t bytes() const { return lists_.bytes(); }

 private:
  void submit(Queue& queue, const CommandList& list);
  void submitSlice();

  Device& device_;
  const LiveCloud& live_;
  const HashUpdate& update_;
  CompactionSlices slices_;
  CompactionLists lists_;
  Stage stage_ = Stage::idle;
  std::uint32_t parity_ = 0;  // of the half that is copied
  Queue* on_ = nullptr;       // the queue of the last submission
  Queue::Ticket ticket_ = 0;
  std::uint32_t base_;  // number of slots in use after the last compaction or build, at most
};

}  // namespace palpate
