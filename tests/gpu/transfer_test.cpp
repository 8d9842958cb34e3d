// Buffers between host and GPU: data uploaded in pieces is downloaded in its order.
#include "engine/gpu/transfer.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <utility>
#include <vector>

#include "engine/gpu/device.hpp"
#include "engine/gpu/unified_memory.hpp"
#include "tests/gpu_fixture.hpp"

namespace palpate::transfer_test {

TEST_CASE_FIXTURE(GpuFixture, "data uploaded in any number of pieces is downloaded unchanged") {
  constexpr std::uint64_t kPiece = std::uint64_t{32} << 20;
  for (const std::uint64_t bytes : {std::uint64_t{4}, kPiece, kPiece + 4, 3 * kPiece + 4}) {
    CAPTURE(bytes);
    const std::size_t count = bytes / sizeof(std::uint32_t);
    const Buffer buffer = Buffer::of<std::uint32_t>(device, count, Memory::device, "transferred");
    std::vector<std::uint64_t> offsets;
    uploadMade(device, latencyQueueOf(device), buffer, bytes, [&](std::uint64_t offset, std::span<std::byte> piece) {
      offsets.push_back(offset);
      for (std::size_t k = 0; k < piece.size(); k += sizeof(std::uint32_t)) {
        const auto number = static_cast<std::uint32_t>((offset + k) / sizeof(std::uint32_t) * 2654435761u);
        std::memcpy(piece.data() + k, &number, sizeof number);
      }
    });
    CHECK(offsets.size() == (bytes + kPiece - 1) / kPiece);
    const auto there = download<std::uint32_t>(device, buffer, count);
    bool same = true;
    for (std::size_t i = 0; i < count; ++i) same = same && there[i] == static_cast<std::uint32_t>(i * 2654435761u);
    CHECK(same);
  }
}

TEST_CASE("only an integrated GPU whose whole memory the host can write is written in place") {
  constexpr VkMemoryPropertyFlags kLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
                                  kCached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT,
                                  kHost = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  constexpr VkMemoryHeapFlags kOwn = VK_MEMORY_HEAP_DEVICE_LOCAL_BIT;
  struct Type {
    VkMemoryPropertyFlags flags;
    std::uint32_t heap;
  };
  const auto reached = [](VkPhysicalDeviceType device, const std::vector<VkMemoryHeap>& heaps,
                          const std::vector<Type>& types) {
    VkPhysicalDeviceMemoryProperties memory{};
    for (const VkMemoryHeap& heap : heaps) memory.memoryHeaps[memory.memoryHeapCount++] = heap;
    for (const Type& type : types) memory.memoryTypes[memory.memoryTypeCount++] = {type.flags, type.heap};
    const UnifiedMemory unified = unifiedMemory(device, memory);
    return std::pair(unified.writes, unified.reads);
  };
  constexpr VkDeviceSize kGiB = 1ull << 30;
  constexpr auto kIntegrated = VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU, kDiscrete = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
  const std::vector<VkMemoryHeap> one{{16 * kGiB, kOwn}};
  CHECK(reached(kIntegrated, one, {{kLocal | kHost | kCached, 0}}) == std::pair(true, true));
  CHECK(reached(kIntegrated, one, {{kLocal, 0}, {kLocal | kHost, 0}, {kLocal | kHost | kCached, 0}}) ==
        std::pair(true, false));
  CHECK(reached(kIntegrated, one, {{kLocal, 0}}) == std::pair(false, false));
  CHECK(reached(VK_PHYSICAL_DEVICE_TYPE_CPU, one, {{kLocal | kHost | kCached, 0}}) == std::pair(false, false));
  // A carve-out of 256 MiB that the host can write, beside the GPU's other memory.
  const std::vector<VkMemoryHeap> carved{{4 * kGiB, kOwn}, {kGiB / 4, kOwn}, {12 * kGiB, 0}};
  CHECK(reached(kIntegrated, carved, {{kLocal, 0}, {kLocal | kHost, 1}, {kHost, 2}}) == std::pair(false, false));
  // A discrete GPU with a resizable BAR: its memory is behind the bus.
  const std::vector<VkMemoryHeap> discrete{{8 * kGiB, kOwn}, {32 * kGiB, 0}};
  CHECK(reached(kDiscrete, discrete, {{kLocal, 0}, {kHost, 1}, {kLocal | kHost, 0}}) == std::pair(false, false));
}

}  // namespace palpate::transfer_test
