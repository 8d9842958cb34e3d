// The handles of the C interface: small numbers that stand for objects, each for one only, ever.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace palpate::library {

enum class HandleKind : std::uint8_t { cloud = 1, session = 2, mesh = 3, frame = 4, matter = 5, log = 6, server = 7 };

/// Objects by their handles: kind, generation of the place, place. For any number of threads; find() takes no lock that
/// is held for longer than it takes to copy a pointer, and allocates nothing unless it fails.
class HandleTable {
 public:
  /// Throws Error when there is no place left.
  std::uint64_t add(HandleKind kind, std::shared_ptr<void> object);
  /// Throws HandleError for a handle that is null, closed, of another kind or no handle at all.
  std::shared_ptr<void> find(HandleKind kind, std::uint64_t handle);
  /// The same, and the handle is closed.
  std::shared_ptr<void> remove(HandleKind kind, std::uint64_t handle);
  /// The same of an object that is not ended here, since it belongs to another process: it stays in memory.
  void abandon(HandleKind kind, std::uint64_t handle) { static_cast<void>(new auto(remove(kind, handle))); }

 private:
  struct Slot {
    std::atomic_flag lock;  // of what follows
    std::shared_ptr<void> object;
    std::uint32_t generation = 1;
    HandleKind kind{};
  };
  static constexpr std::size_t kSlots = 1024, kChunks = 1024;  // a million handles at a time
  using Chunk = std::array<Slot, kSlots>;

  // Null where no handle ever had the place.
  Slot* slotAt(std::uint32_t place);
  Slot& slotOf(HandleKind kind, std::uint64_t handle);
  std::uint32_t freePlace();

  std::array<std::atomic<Chunk*>, kChunks> chunks_{};
  std::mutex lock_;  // of what follows
  std::vector<std::unique_ptr<Chunk>> owned_;
  std::vector<std::uint32_t> free_;
};

/// Of the library, for as long as the program runs.
HandleTable& handles();

}  // namespace palpate::library
