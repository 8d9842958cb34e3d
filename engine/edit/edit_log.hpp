#pragma once

#include <atomic>
#include <cstdint>

#include "engine/gpu/buffer.hpp"
#include "shaders/shared/edit_log.h"

namespace palpate {

/// The only place where the touch side and the sight side meet: a ring of point moves on the GPU, written by the edit
/// passes of the touch side, read by whoever attached. Positions in the log grow without bound; a position's slot is
/// its remainder by the capacity.
///
/// One writer thread and one reader thread. The writer publishes what has completed on the GPU; the reader says what it
/// has consumed; neither waits for the other. With no reader attached nothing is kept.
class EditLog {
 public:
  /// Moves kept beside a tick that moves the whole cloud, at least: a reader at 30 Hz may fall a frame behind a brush
  /// at 1 kHz.
  static constexpr std::uint64_t kLeastSlack = 1 << 18;

  /// Holds at least twice `points` moves, so that a tick that moves the whole cloud fits beside what a reader that is a
  /// little behind has not seen yet.
  EditLog(Device& device, std::uint64_t points, std::uint64_t slack = kLeastSlack);
  /// Entries that a log for so many points holds.
  static std::uint64_t capacityFor(std::uint64_t points, std::uint64_t slack = kLeastSlack);

  DeviceAddress entries() const { return entries_.address(); }
  const Buffer& entriesBuffer() const { return entries_; }
  /// A uint32 that shaders count up: the position of the next entry, modulo 2^32.
  DeviceAddress head() const { return head_.address(); }
  const Buffer& headBuffer() const { return head_; }
  std::uint64_t capacity() const { return capacity_; }

  // Writer.
  /// All entries before the position whose low 32 bits are `head` are complete on the GPU.
  void publish(std::uint32_t head);
  /// Entries that may be written now without overwriting unread ones.
  std::uint64_t room() const;

  // Reader.
  struct Range {
    std::uint64_t begin = 0, end = 0;
    std::uint64_t size() const { return end - begin; }
  };
  /// From now on unread entries are kept.
  void attachReader();
  /// Nothing is kept any more.
  void detachReader();
  Range unread() const;
  void consume(std::uint64_t upTo);

 private:
  std::uint64_t capacity_;
  Buffer entries_, head_;
  std::atomic<std::uint64_t> published_ = 0;
  std::atomic<std::uint64_t> consumed_ = 0;
  std::atomic<bool> hasReader_ = false;
};

}  // namespace palpate
