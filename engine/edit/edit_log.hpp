#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/core/edit_batch.hpp"
#include "engine/gpu/buffer.hpp"
#include "shaders/shared/edit_log.h"

namespace palpate {

// The host's states and the GPU's entries are the same bytes.
static_assert(sizeof(PointState) == sizeof(shared::EditEntry));
static_assert(offsetof(PointState, position) == offsetof(shared::EditEntry, position));
static_assert(offsetof(PointState, id) == offsetof(shared::EditEntry, id));
static_assert(offsetof(PointState, normal) == offsetof(shared::EditEntry, normal));
static_assert(offsetof(PointState, color) == offsetof(shared::EditEntry, color));
static_assert(offsetof(PointState, parent) == offsetof(shared::EditEntry, parent));
static_assert(PointState::kGone == shared::kPointGone);

/// The only place where the touch side and those who follow it meet: a ring of point states on the GPU, written by the
/// edit passes of the touch side, read by whoever attached a Reader. Positions in the log grow without bound; a
/// position's slot is its remainder by the capacity. A small ring of marks on the host tells where strokes and changes
/// end.
///
/// One writer thread, and one thread for each reader. The writer publishes what has completed on the GPU; a reader says
/// what it has consumed; nobody waits for anybody. With no reader attached nothing is kept.
class EditLog {
 public:
  /// States kept beside a tick that edits the whole cloud, at least: a reader at 30 Hz may fall a frame behind a brush
  /// at 1 kHz.
  static constexpr std::uint64_t kMinSlack = 1 << 18;

  /// Holds at least twice `points` states, so that a tick that edits the whole cloud fits beside what a reader that is
  /// a little behind has not seen yet; at most as many as one buffer can (capacityFor()).
  EditLog(Device& device, std::uint64_t points, std::uint64_t slack = kMinSlack);
  /// Entries that a log for so many points holds.
  static std::uint64_t capacityFor(std::uint64_t points, std::uint64_t slack = kMinSlack);

  DeviceAddress entries() const { return entries_.address(); }
  const Buffer& entriesBuffer() const { return entries_; }
  /// A uint32 that shaders count up: the position of the next entry, modulo 2^32.
  DeviceAddress head() const { return head_.address(); }
  const Buffer& headBuffer() const { return head_; }
  std::uint64_t capacity() const { return capacity_; }

  // Writer.
  /// All entries before the position whose low 32 bits are `head` are complete on the GPU.
  void publish(std::uint32_t head);
  /// The same for the entries of one change(), with the mark that ends them: no reader sees the former without the
  /// latter.
  /// False where there are none.
  bool publishChange(std::uint32_t head);
  /// The same for what has become of an offer, should it be nothing, too. `inStroke`: of a brush, which goes on behind
  /// it.
  void publishReceived(std::uint32_t head, bool inStroke);
  /// The stroke ended with the last entry that is published.
  void endStroke() { mark(published_.load(std::memory_order_relaxed), EditMark::Kind::stroke); }
  /// Entries that may be written now without overwriting unread ones; none while a reader has left too many marks
  /// unread.
  std::uint64_t room() const;
  /// Where the next entry will stand that is not published yet.
  std::uint64_t published() const { return published_.load(std::memory_order_relaxed); }

  struct Range {
    std::uint64_t begin = 0, end = 0;
    std::uint64_t size() const { return end - begin; }
  };
  /// Keeps what it has not consumed for as long as it lives. Made while nothing is written: before the first edit.
  class Reader;

 private:
  static constexpr std::size_t kMaxReaders = 4;
  static constexpr std::uint64_t kMarks = 1024, kMarksPerTick = 4;  // two of a stroke and a change, two of an offer

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
  /// Appends the unread marks up to the position `upTo`, which unread() has given, with `at` counted from `from`, and
  /// consumes them.
  void takeMarks(std::uint64_t from, std::uint64_t upTo, std::vector<EditMark>& marks);
  /// The entries before `upTo`, and the marks among them, are no longer needed.
  void consume(std::uint64_t upTo);

 private:
  EditLog& log_;
  Seat& seat_;
};

}  // namespace palpate
