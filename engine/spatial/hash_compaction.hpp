#pragma once

#include <cstdint>

#include "engine/gpu/queue.hpp"
#include "engine/spatial/compaction_lists.hpp"
#include "engine/spatial/compaction_slices.hpp"
#include "engine/spatial/hash_update.hpp"

namespace palpate {

struct CompactionOptions {
  /// In one submission; 0: many where the background has a queue of its own, few where it holds up the touch side.
  std::uint32_t bucketsPerSlice = 0;
  /// Buckets that may change while it runs; at most as many as the HashUpdate notes.
  std::uint32_t mostDirty = ~0u;
};

/// Brings the points of an index that has followed edits together again, in the back half of the live cloud, while
/// edits and queries go on in the front half. One call at a time, by the thread that edits; none waits but those that
/// say so, and none allocates or records. The order of points within a bucket stays what it is.
///
/// idle, begin(), noting, advance(), copying, advance(), …, copied, end(), ending, collect(), idle. While stage() is
/// copying, nothing else may write the back half; abandon() first.
class HashCompaction {
 public:
  enum class Stage { idle, noting, copying, abandoning, copied, ending };

  /// All must outlive it. Waits until its passes have run once, for nothing.
  HashCompaction(Device& device, const SpatialHash& hash, const LiveCloud& live, const HashUpdate& update,
                 const CompactionOptions& options = {});
  /// Waits for what is under way, as far as the GPU is still there.
  ~HashCompaction();
  HashCompaction(const HashCompaction&) = delete;
  HashCompaction& operator=(const HashCompaction&) = delete;

  Stage stage() const { return stage_; }
  /// Whether more than half of the slots are used that were free after the last compaction, and enough can be won back;
  /// from the report of an edit that has completed.
  bool isDue(const shared::HashUpdate& report);

  /// From idle. Its list goes to the latency queue: from there on edits note the buckets that they change.
  void begin();
  /// Submits the next slice to the background queue when what went before has completed. Also makes an end to
  /// abandoning.
  void advance();
  /// From copied. Its list goes to the latency queue behind the last edit: buckets that were changed are copied again.
  void end();
  /// From ending, once the list of end() has completed, and before anything else is submitted that edits: true when the
  /// caller must flip the live cloud; false when it did not come out, and all is as if it had not been begun.
  bool collect();
  /// The list that end() submitted.
  Queue::Ticket endTicket() const { return ticket_; }

  /// Gives it up. What is under way goes on; isIdle() after advance() says when it has ended. Not from ending.
  void abandon();
  bool isIdle() const { return stage_ == Stage::idle; }
  /// Gives it up and waits for what is under way.
  void settle();
  /// From begin() to the end at once; as collect(). Waits.
  bool run();

  std::uint32_t slices() const { return slices_.count(); }
  /// Of the last end().
  const shared::HashCompaction& report() const { return lists_.report(); }
  /// GPU times of the last slice and of the last list of end(), us: the latter is what the touch side waits for.
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
  std::uint32_t base_;  // no more slots were in use after the last compaction or build
};

}  // namespace palpate
