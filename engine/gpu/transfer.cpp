#include "engine/gpu/transfer.hpp"

#include <algorithm>
#include <cstring>

#include "engine/gpu/command_list.hpp"
#include "engine/gpu/device.hpp"

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

void uploadBytes(Device& device, Queue& queue, const Buffer& to, std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  const Buffer staging(device, std::min<std::uint64_t>(bytes.size(), kStagingBytes), Memory::staging, "staging");
  CommandList list(device, queue, "upload " + to.name());
  inPieces(bytes.size(), [&](std::uint64_t offset, std::uint64_t piece) {
    std::memcpy(staging.mapped<std::byte>().data(), bytes.data() + offset, piece);
    list.begin();
    list.copy(staging, to, piece, 0, offset);
    list.end();
    queue.run(list);
  });
}

void downloadBytes(Device& device, Queue& queue, const Buffer& from, std::span<std::byte> bytes, std::uint64_t offset) {
  if (bytes.empty()) return;
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
