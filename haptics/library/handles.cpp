#include "haptics/library/handles.hpp"

#include <string_view>
#include <thread>
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

/// A slot's claim: the generation, whether its handle is open, and how many threads look at the object.
constexpr std::uint64_t kOpen = std::uint64_t{1} << 31, kLook = 1, kLooks = kOpen - 1;
constexpr int kGenerationShift = 32;

bool isOpen(std::uint64_t claim, std::uint32_t generation) {
  return (claim & kOpen) != 0 && claim >> kGenerationShift == generation;
}

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
  slot.object = std::move(object);
  slot.kind = kind;
  const std::uint64_t before = slot.claim.fetch_or(kOpen);
  return handleFor(kind, static_cast<std::uint32_t>(before >> kGenerationShift), place);
}

HandleTable::Slot& HandleTable::slotOf(HandleKind kind, std::uint64_t handle) {
  if (handle == 0) throw HandleError("the {} is closed", nameOf(kind));
  const std::string_view its = nameOf(kindIn(handle));
  Slot* const slot = its.empty() ? nullptr : slotAt(placeIn(handle));
  if (!slot) throw HandleError("{:#x} is not a handle of palpate", handle);
  if (kindIn(handle) != kind) throw HandleError("a {} was given, but a {} is required", its, nameOf(kind));
  return *slot;
}

// Never waits: a thread that is preempted here delays only the closing of the handle.
std::shared_ptr<void> HandleTable::find(HandleKind kind, std::uint64_t handle) {
  Slot& slot = slotOf(kind, handle);
  std::shared_ptr<void> found;
  if (isOpen(slot.claim.fetch_add(kLook), generationIn(handle)) && slot.kind == kind) found = slot.object;
  slot.claim.fetch_sub(kLook);
  if (!found) throw HandleError("the {} is closed", nameOf(kind));
  return found;
}

void HandleTable::close(Slot& slot, HandleKind kind, std::uint64_t handle) {
  std::uint64_t claim = slot.claim;
  do {
    if (!isOpen(claim, generationIn(handle)) || slot.kind != kind) throw HandleError("the {} is closed", nameOf(kind));
  } while (!slot.claim.compare_exchange_weak(claim, claim & ~kOpen));
}

std::shared_ptr<void> HandleTable::remove(HandleKind kind, std::uint64_t handle) {
  Slot& slot = slotOf(kind, handle);
  close(slot, kind, handle);
  while ((slot.claim & kLooks) != 0) std::this_thread::yield();
  std::shared_ptr<void> found = std::move(slot.object);
  slot.claim += std::uint64_t{1} << kGenerationShift;
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
