#include "engine/spatial/prefix_scan.hpp"

#include <numeric>
#include <random>

#include "engine/gpu/transfer.hpp"
#include "tests/gpu_fixture.hpp"

namespace palpate {

TEST_CASE_FIXTURE(GpuFixture, "the exclusive prefix sum of any count equals the one on the CPU") {
  const PrefixScan scan(device);
  for (const std::uint32_t count : {0u, 1u, 255u, 256u, 257u, 2047u, 2048u, 2049u, 65'537u, 1'000'003u}) {
    CAPTURE(count);
    std::mt19937 random(count);
    std::vector<std::uint32_t> values(count), expected(count);
    for (auto& value : values) value = static_cast<std::uint32_t>(random());  // sums wrap around, as they should
    std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0u);

    const Buffer data = Buffer::of<std::uint32_t>(device, count, Memory::device, "values");
    const Buffer scratch(device, PrefixScan::scratchBytes(count), Memory::device, "scratch");
    upload(device, data, values);
    CommandList list(device, device.touch(), "scan");
    list.begin();
    scan.record(list, {data.address(), scratch.address()}, count);
    list.end();
    device.touch().run(list);
    CHECK(download<std::uint32_t>(device, data, count) == expected);
  }
}

}  // namespace palpate
