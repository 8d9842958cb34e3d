#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "engine/gpu/queue.hpp"
#include "engine/spatial/hash_update.hpp"
#include "shaders/shared/hash_compaction.h"

namespace palpate {

struct CompactionOptions {
  /// In one submission; 0: many where the background has a queue of its own, few where it holds up the touch side.
  std::uint32_t bucketsPerSlice = 0;
  /// Buckets that may change while it runs; at most as many as the HashUpdate notes.
  std::uint32_t mostDirty = ~0u;
};

/// Brings the points of an index that has followed edits together again, on the other side of the live cloud, while
/// edits and queries go on on the side in use. One call at a time, by the thread that edits; none waits but those that
/// say so, and none allocates or records. The order of points within a bucket stays what it is.
///
/// idle, begin(), noting, advance(), copying, advance(), …, copied, end(), ending, collect(), idle. While stage() is
/// copying, nothing else may write the other side; abandon() first.
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

  /// From idle. Its list goes to the touch queue: from there on edits note the buckets that they change.
  void begin();
  /// Submits the next slice to the background queue when what went before has completed. Also makes an end to
  /// abandoning.
  void advance();
  /// From copied. Its list goes to the touch queue behind the last edit: buckets that were changed are copied again.
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

  std::uint32_t slices() const { return clears_ + copies_; }
  /// Of the last end().
  const shared::HashCompaction& report() const { return report_.mapped<const shared::HashCompaction>()[0]; }
  /// GPU times of the last slice and of the last list of end(), us: the latter is what the touch side waits for.
  double sliceTime_us() const { return slice_[parity_]->sectionTime_us("compaction"); }
  double endTime_us() const { return end_[parity_]->sectionTime_us("compaction"); }
  std::uint64_t bytes() const { return state_.bytes() + report_.bytes() + sliceOf_.bytes(); }

 private:
  void record(std::uint32_t parity, const LiveCloud::Side& from, const LiveCloud::Side& to, std::uint32_t mostDirty);
  void warmUp();
  void submit(Queue& queue, const CommandList& list);
  void submitSlice();

  Device& device_;
  const SpatialHash& hash_;
  const LiveCloud& live_;
  const HashUpdate& update_;
  ComputePipeline slicePass_, plan_, again_, finish_;
  Buffer state_, report_, sliceOf_;
  std::uint32_t bucketsPerSlice_, slotsPerSlice_, clears_, copies_;
  // One for each side that may be in use.
  std::array<std::unique_ptr<CommandList>, 2> begin_, slice_, end_;
  Stage stage_ = Stage::idle;
  std::uint32_t parity_ = 0;  // of the side that is copied
  std::uint32_t next_ = 0;    // slice
  Queue* on_ = nullptr;       // the queue of the last submission
  Queue::Ticket ticket_ = 0;
  std::uint32_t base_;  // no more slots were in use after the last compaction or build
};

}  // namespace palpate
