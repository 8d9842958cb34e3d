// Buffers between host and GPU: data uploaded in pieces is downloaded in its order.
#include "engine/gpu/transfer.hpp"

#include <doctest/doctest.h>

#include <cstring>

#include "engine/gpu/device.hpp"
#include "tests/gpu_fixture.hpp"

namespace palpate::transfer_test {

TEST_CASE_FIXTURE(GpuFixture, "data uploaded in any number of pieces is downloaded unchanged") {
  constexpr std::uint64_t kPiece = std::uint64_t{64} << 20;
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

}  // namespace palpate::transfer_test
