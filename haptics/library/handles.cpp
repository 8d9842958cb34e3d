#include "haptics/library/handles.hpp"

#include <string_view>
#include <utility>

#include "haptics/library/failures.hpp"

namespace palpate::library {

namespace {

constexpr int kPlaceBits = 24, kGenerationBits = 32;

std::uint64_t handleFor(HandleKind kind, std::uint32_t generation, std::uint32_t place) {
  return std::uint64_t{static_cast<std::uint8_t>(kind)} << (kPlaceBits + kGenerationBits) |
         std::uint64_t{generation} << kPlaceBits | place;
}
std::uint32_t placeIn(std::uint64_t handle) { return handle & ((1u << kPlaceBits) - 1); }
std::uint32_t generationIn(std::uint64_t handle) { return static_cast<std::uint32_t>(handle >> kPlaceBits); }
HandleKind kindIn(std::uint64_t handle) { return static_cast<HandleKind>(handle >> (kPlaceBits + kGenerationBits)); }

std::string_view nameOf(HandleKind kind) {
  switch (kind) {
    case HandleKind::cloud:
      return "cloud";
    case HandleKind::session:
      return "session";
    case HandleKind::mesh:
      return "mesh";
    case HandleKind::frame:
      return "frame";
    case HandleKind::matter:
      return "matter";
    case HandleKind::log:
      return "log";
    case HandleKind::server:
      return "server";
  }
  return {};
}

/// Spin lock, held for a few instructions: waiting in the kernel would take longer.
class Held {
 public:
  explicit Held(std::atomic_flag& flag) : flag_(flag) {
    while (flag_.test_and_set(std::memory_order_acquire)) {
    }
  }
  ~Held() { flag_.clear(std::memory_order_release); }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;

 private:
  std::atomic_flag& flag_;
};

}  // namespace

HandleTable::Slot* HandleTable::slotAt(std::uint32_t place) {
  if (place >= kSlots * kChunks) return nullptr;
  Chunk* const chunk = chunks_[place / kSlots].load(std::memory_order_acquire);
  return chunk ? &(*chunk)[place % kSlots] : nullptr;
}

std::uint32_t HandleTable::freePlace() {
  const std::scoped_lock lock(lock_);
  if (free_.empty()) {
    if (owned_.size() == kChunks) throw Error("{} handles are open, which is the maximum", kSlots * kChunks);
    free_.reserve((owned_.size() + 1) * kSlots);  // first: nothing below, nor remove(), may fail half done
    owned_.push_back(std::make_unique<Chunk>());
    chunks_[owned_.size() - 1].store(owned_.back().get(), std::memory_order_release);
    const auto first = static_cast<std::uint32_t>((owned_.size() - 1) * kSlots);
    for (std::uint32_t k = kSlots; k-- > 0;) free_.push_back(first + k);
  }
  const std::uint32_t place = free_.back();
  free_.pop_back();
  return place;
}

std::uint64_t HandleTable::add(HandleKind kind, std::shared_ptr<void> object) {
  const std::uint32_t place = freePlace();
  Slot& slot = *slotAt(place);
  const Held held(slot.lock);
  slot.object = std::move(object);
  slot.kind = kind;
  return handleFor(kind, slot.generation, place);
}

HandleTable::Slot& HandleTable::slotOf(HandleKind kind, std::uint64_t handle) {
  if (handle == 0) throw HandleError("the {} is closed", nameOf(kind));
  const std::string_view its = nameOf(kindIn(handle));
  Slot* const slot = its.empty() ? nullptr : slotAt(placeIn(handle));
  if (!slot) throw HandleError("{:#x} is not a handle of palpate", handle);
  if (kindIn(handle) != kind) throw HandleError("a {} was given, but a {} is required", its, nameOf(kind));
  return *slot;
}

std::shared_ptr<void> HandleTable::find(HandleKind kind, std::uint64_t handle) {
  Slot& slot = slotOf(kind, handle);
  std::shared_ptr<void> found;
  {
    const Held held(slot.lock);
    if (slot.kind == kind && slot.generation == generationIn(handle)) found = slot.object;
  }
  if (!found) throw HandleError("the {} is closed", nameOf(kind));
  return found;
}

std::shared_ptr<void> HandleTable::remove(HandleKind kind, std::uint64_t handle) {
  Slot& slot = slotOf(kind, handle);
  std::shared_ptr<void> found;
  {
    const Held held(slot.lock);
    if (slot.kind == kind && slot.generation == generationIn(handle)) {
      found = std::exchange(slot.object, nullptr);
      ++slot.generation;
    }
  }
  if (!found) throw HandleError("the {} is closed", nameOf(kind));
  const std::scoped_lock lock(lock_);
  free_.push_back(placeIn(handle));
  return found;
}

HandleTable& handles() {
  // Never destroyed: other threads of the host may still be in calls when the program ends.
  static HandleTable& table = *new HandleTable;
  return table;
}

}  // namespace palpate::library
