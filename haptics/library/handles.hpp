// Handles of the C interface: small numbers, each of which stands for one object only and is never reused.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace palpate::library {

enum class HandleKind : std::uint8_t { cloud = 1, session = 2, mesh = 3, frame = 4, matter = 5, log = 6, server = 7 };

/// Table of objects by handle. A handle consists of kind, generation and index of a slot. Any number of threads may use
/// it. find() takes no lock, and allocates nothing unless it fails.
class HandleTable {
 public:
  /// Throws Error if the table is full.
  std::uint64_t add(HandleKind kind, std::shared_ptr<void> object);
  /// Throws HandleError for a handle that is null, closed, of another kind or invalid.
  std::shared_ptr<void> find(HandleKind kind, std::uint64_t handle);
  /// find(), and closes the handle.
  std::shared_ptr<void> remove(HandleKind kind, std::uint64_t handle);
  /// remove() for an object that belongs to another process: it is not destroyed, and its memory is leaked, as is the
  /// slot, at which a thread of that process may have looked when this one was forked.
  void abandon(HandleKind kind, std::uint64_t handle) { close(slotOf(kind, handle), kind, handle); }

 private:
  struct Slot {
    std::atomic<std::uint64_t> claim = std::uint64_t{1} << 32;  // the first generation, closed
    // Constant while the handle is open, and while a thread that found it open looks at them.
    std::shared_ptr<void> object;
    std::atomic<HandleKind> kind{};
  };
  static constexpr std::size_t kSlots = 1024, kChunks = 1024;  // a million open handles
  using Chunk = std::array<Slot, kSlots>;

  // Null if no handle has used the slot so far.
  Slot* slotAt(std::uint32_t place);
  Slot& slotOf(HandleKind kind, std::uint64_t handle);
  static void close(Slot& slot, HandleKind kind, std::uint64_t handle);
  std::uint32_t freePlace();

  std::array<std::atomic<Chunk*>, kChunks> chunks_{};
  std::mutex lock_;  // guards the members below
  std::vector<std::unique_ptr<Chunk>> owned_;
  std::vector<std::uint32_t> free_;
};

/// The table of the library, for the lifetime of the program.
HandleTable& handles();

}  // namespace palpate::library
