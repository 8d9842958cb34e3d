#include "engine/gpu/transfer.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <optional>

#include "engine/gpu/command_list.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/unified_memory.hpp"

namespace palpate {

namespace {

constexpr std::uint64_t kStagingBytes = 64ull << 20;

// Calls step(offset, bytes) for consecutive pieces.
template <class Step>
void inPieces(std::uint64_t total, Step&& step) {
  for (std::uint64_t offset = 0; offset < total; offset += kStagingBytes)
    step(offset, std::min(kStagingBytes, total - offset));
}

}  // namespace

void uploadMade(Device& device, Queue& queue, const Buffer& to, std::uint64_t bytes,
                const std::function<void(std::uint64_t, std::span<std::byte>)>& make) {
  if (unifiedMemory(device).writes) {
    queue.finish();  // which may still use the buffer
    const std::span<std::byte> there = to.mapped<std::byte>();
    inPieces(bytes, [&](std::uint64_t offset, std::uint64_t piece) { make(offset, there.subspan(offset, piece)); });
    return;
  }
  struct Turn {
    Turn(Device& device, Queue& queue, std::uint64_t bytes, const std::string& name)
        : staging(device, bytes, Memory::staging, "staging"), list(device, queue, "upload " + name) {}
    Buffer staging;
    CommandList list;
    std::optional<Queue::Ticket> copying;
  };
  std::array<std::unique_ptr<Turn>, 2> turns;
  const auto waitForAll = [&] {
    for (const std::unique_ptr<Turn>& turn : turns)
      if (turn && turn->copying) queue.wait(*turn->copying);
  };
  std::size_t number = 0;
  try {
    inPieces(bytes, [&](std::uint64_t offset, std::uint64_t piece) {
      std::unique_ptr<Turn>& turn = turns[number++ % turns.size()];
      if (!turn) turn = std::make_unique<Turn>(device, queue, std::min(bytes, kStagingBytes), to.name());
      if (turn->copying) queue.wait(*turn->copying);
      make(offset, turn->staging.mapped<std::byte>().first(piece));
      turn->list.begin();
      turn->list.copy(turn->staging, to, piece, 0, offset);
      turn->list.end();
      turn->copying = queue.submit(turn->list);
    });
  } catch (...) {
    waitForAll();  // before the staging memory is destroyed
    throw;
  }
  waitForAll();
}

void uploadBytes(Device& device, Queue& queue, const Buffer& to, std::span<const std::byte> bytes) {
  uploadMade(device, queue, to, bytes.size(), [&](std::uint64_t offset, std::span<std::byte> piece) {
    std::memcpy(piece.data(), bytes.data() + offset, piece.size());
  });
}

void downloadBytes(Device& device, Queue& queue, const Buffer& from, std::span<std::byte> bytes, std::uint64_t offset) {
  if (bytes.empty()) return;
  if (unifiedMemory(device).reads) {
    queue.finish();  // each list ends with a barrier for the host's reads
    std::memcpy(bytes.data(), from.mapped<std::byte>().data() + offset, bytes.size());
    return;
  }
  const Buffer staging(device, std::min<std::uint64_t>(bytes.size(), kStagingBytes), Memory::readback, "download");
  CommandList list(device, queue, "download " + from.name());
  inPieces(bytes.size(), [&](std::uint64_t done, std::uint64_t piece) {
    list.begin();
    list.copy(from, staging, piece, offset + done, 0);
    list.end();
    queue.run(list);
    std::memcpy(bytes.data() + done, staging.mapped<std::byte>().data(), piece);
  });
}

Queue& latencyQueueOf(Device& device) { return device.latencyQueue(); }

}  // namespace palpate
