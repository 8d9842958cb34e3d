#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/core/edit_batch.hpp"
#include "engine/core/packed_state.hpp"
#include "engine/gpu/buffer.hpp"
#include "shaders/shared/edit_log.h"

namespace palpate {

// The host's packed states and the GPU's entries are the same bytes.
static_assert(sizeof(PackedState) == sizeof(shared::EditEntry));
static_assert(offsetof(PackedState, position) == offsetof(shared::EditEntry, position));
static_assert(offsetof(PackedState, id) == offsetof(shared::EditEntry, id));
static_assert(offsetof(PackedState, normal) == offsetof(shared::EditEntry, normal));
static_assert(offsetof(PackedState, color) == offsetof(shared::EditEntry, color));
static_assert(offsetof(PackedState, parent) == offsetof(shared::EditEntry, parent));
static_assert(PackedState::kGone == shared::kPointGone);

/// The interface between the touch side and its followers: a ring of point states on the GPU, written by the edit
/// passes of the touch side and read by every attached Reader. Positions in the log grow without bound; the slot of a
/// position is its remainder modulo the capacity. A small ring of marks on the host stores where strokes and changes
/// end.
///
/// One writer thread, and one thread for each reader. The writer publishes entries that are complete on the GPU; a
/// reader reports what it has consumed; neither waits for the other. Without readers nothing is kept.
class EditLog {
 public:
  /// Minimum number of states kept in addition to a tick that edits the whole cloud: a reader at 30 Hz may fall a frame
  /// behind a brush at 1 kHz.
  static constexpr std::uint64_t kMinSlack = 1 << 18;

  /// Holds at least twice `points` states, so that a tick that edits the whole cloud fits in addition to entries that a
  /// slightly late reader has not read; limited by the size of one buffer (capacityFor()).
  EditLog(Device& device, std::uint64_t points, std::uint64_t slack = kMinSlack);
  /// Capacity of a log for `points` points.
  static std::uint64_t capacityFor(std::uint64_t points, std::uint64_t slack = kMinSlack);

  DeviceAddress entries() const { return entries_.address(); }
  const Buffer& entriesBuffer() const { return entries_; }
  /// A uint32 that shaders increment: the position of the next entry, modulo 2^32.
  DeviceAddress head() const { return head_.address(); }
  const Buffer& headBuffer() const { return head_; }
  std::uint64_t capacity() const { return capacity_; }

  // Writer.
  /// Publishes all entries before the position whose low 32 bits are `head`; they must be complete on the GPU.
  void publish(std::uint32_t head);
  /// Publishes the entries of one change() with the mark that ends them: readers never see the entries without the
  /// mark. False if there are no entries.
  bool publishChange(std::uint32_t head);
  /// Publishes the result of an offer, even if it is empty. `inStroke`: a brush stroke continues after it.
  void publishReceived(std::uint32_t head, bool inStroke);
  /// Ends the stroke with the last published entry.
  void endStroke() { mark(published_.load(std::memory_order_relaxed), EditMark::Kind::stroke); }
  /// Number of entries that may be written now without overwriting unread ones; 0 while a reader has too many unread
  /// marks.
  std::uint64_t room() const;
  /// Position of the next entry to be published.
  std::uint64_t published() const { return published_.load(std::memory_order_relaxed); }

  struct Range {
    std::uint64_t begin = 0, end = 0;
    std::uint64_t size() const { return end - begin; }
  };
  /// Its unconsumed entries are kept while it lives. Must be created while nothing is written: before the first edit.
  class Reader;

 private:
  static constexpr std::size_t kMaxReaders = 4;
  static constexpr std::uint64_t kMarks = 1024, kMarksPerTick = 4;  // two for a stroke and a change, two for an offer

  struct Seat {
    std::atomic<bool> taken = false;
    std::atomic<std::uint64_t> consumed = 0;  // entries
    std::atomic<std::uint64_t> consumedMarks = 0;
  };
  std::uint64_t positionOf(std::uint32_t head) const;
  void mark(std::uint64_t position, EditMark::Kind kind);

  std::uint64_t capacity_;
  Buffer entries_, head_;
  std::atomic<std::uint64_t> published_ = 0;
  std::array<EditMark, kMarks> marks_;  // `at` is a position in the log
  std::atomic<std::uint64_t> marked_ = 0;
  std::array<Seat, kMaxReaders> seats_;
};

class EditLog::Reader {
 public:
  explicit Reader(EditLog& log);
  ~Reader();
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  const EditLog& log() const { return log_; }
  Range unread() const;
  /// Appends the unread marks up to the position `upTo`, as returned by unread(), with `at` relative to `from`, and
  /// consumes them.
  void takeMarks(std::uint64_t from, std::uint64_t upTo, std::vector<EditMark>& marks);
  /// Releases the entries before `upTo` and the marks among them.
  void consume(std::uint64_t upTo);

 private:
  EditLog& log_;
  Seat& seat_;
};

}  // namespace palpate
