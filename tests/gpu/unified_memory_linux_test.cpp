// Transfers on a GPU that shares the CPU's memory: an integrated one, made up from the driver that is here.
#include "engine/gpu/unified_memory.hpp"

#include <algorithm>
#include <vector>

#include "engine/gpu/transfer.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/lost_gpu/lost_gpu.hpp"

namespace palpate::unified_memory_test {

TEST_SUITE_BEGIN(kPortable);

TEST_CASE("memory that is the CPU's own is written and read in place, without a staging buffer") {
  constexpr std::uint64_t kBytes = 4 << 20;
  struct Seen {
    std::uint64_t staged = 0;  // bytes allocated during the upload
    std::vector<std::uint32_t> values;
  };
  const auto uploaded = [&](Device& device) {
    const Buffer buffer(device, kBytes, Memory::device, "transferred");
    const std::uint64_t before = device.allocatedBytes();
    Seen seen;
    uploadMade(device, latencyQueueOf(device), buffer, kBytes, [&](std::uint64_t offset, std::span<std::byte> piece) {
      seen.staged = std::max(seen.staged, device.allocatedBytes() - before);
      for (std::size_t k = 0; k < piece.size(); ++k) piece[k] = static_cast<std::byte>((offset + k) * 7 % 251);
    });
    seen.values = download<std::uint32_t>(device, buffer, kBytes / sizeof(std::uint32_t));
    return seen;
  };
  const Seen copied = uploaded(plainDevice());
  const LostGpuLayer layer(kMinGpu + ",deviceType=1");
  Device integrated({.gpu = "", .validation = askedCoreValidation()});
  const Seen direct = uploaded(integrated);
  CHECK(copied.staged >= kBytes);
  CHECK(direct.staged == 0);
  CHECK(direct.values == copied.values);
  CHECK(direct.values[1] == 0x312a231cu);  // 28, 35, 42, 49
  CHECK(integrated.instance().messages().take().empty());
}

TEST_SUITE_END();

}  // namespace palpate::unified_memory_test
