#include "engine/edit/edit_log.hpp"

#include <algorithm>
#include <bit>

#include "engine/gpu/transfer.hpp"

namespace palpate {

std::uint64_t EditLog::capacityFor(std::uint64_t points, std::uint64_t slack) {
  if (points == 0) return 1;  // nobody edits
  return std::bit_ceil(points + std::max(points, slack));
}

EditLog::EditLog(Device& device, std::uint64_t points, std::uint64_t slack)
    : capacity_(capacityFor(points, slack)),
      entries_(Buffer::of<shared::EditEntry>(device, capacity_, Memory::device, "edit log")),
      head_(Buffer::of<std::uint32_t>(device, 1, Memory::device, "edit log head")) {
  upload(device, head_, std::vector<std::uint32_t>{0});
}

void EditLog::publish(std::uint32_t head) {
  const std::uint64_t before = published_.load(std::memory_order_relaxed);
  const std::uint32_t grown = head - static_cast<std::uint32_t>(before);
  published_.store(before + grown, std::memory_order_release);
}

std::uint64_t EditLog::room() const {
  if (!hasReader_.load(std::memory_order_acquire)) return capacity_;
  return capacity_ - (published_.load(std::memory_order_relaxed) - consumed_.load(std::memory_order_acquire));
}

void EditLog::attachReader() {
  consumed_.store(published_.load(std::memory_order_acquire), std::memory_order_release);
  hasReader_.store(true, std::memory_order_release);
}

void EditLog::detachReader() { hasReader_.store(false, std::memory_order_release); }

EditLog::Range EditLog::unread() const {
  return {consumed_.load(std::memory_order_relaxed), published_.load(std::memory_order_acquire)};
}

void EditLog::consume(std::uint64_t upTo) {
  PALPATE_CHECK_LE(upTo, published_.load(std::memory_order_acquire));
  consumed_.store(upTo, std::memory_order_release);
}

}  // namespace palpate
