#include "engine/spatial/prefix_scan.hpp"

#include <numeric>
#include <random>

#include "engine/gpu/transfer.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"

namespace palpate::prefix_scan_test {

TEST_SUITE_BEGIN(kPortable);

TEST_CASE_FIXTURE(GpuFixture, "the exclusive prefix sum of any count equals the CPU's") {
  const PrefixScan scan(device);
  for (const std::uint32_t count : {0u, 1u, 255u, 256u, 257u, 2047u, 2048u, 2049u, 65'537u, 1'000'003u}) {
    CAPTURE(count);
    std::mt19937 random(count);
    std::vector<std::uint32_t> values(count), expected(count);
    for (auto& value : values) value = static_cast<std::uint32_t>(random());  // sums overflow, as intended
    std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0u);

    const Buffer data = Buffer::of<std::uint32_t>(device, count, Memory::device, "values");
    const Buffer scratch(device, PrefixScan::scratchBytes(count), Memory::device, "scratch");
    upload(device, data, values);
    CommandList list(device, device.latencyQueue(), "scan");
    list.begin();
    scan.record(list, {data.address(), scratch.address()}, count);
    list.end();
    device.latencyQueue().run(list);
    CHECK(download<std::uint32_t>(device, data, count) == expected);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "several arrays are summed independently in one pass") {
  const PrefixScan scan(device);
  for (const std::uint32_t count : {1u, 2049u, 70'001u}) {
    CAPTURE(count);
    const std::uint64_t scratchBytes = PrefixScan::scratchBytes(count);
    const Buffer scratch(device, 3 * scratchBytes, Memory::device, "scratch");
    std::vector<Buffer> data;
    std::vector<PrefixScan::Io> arrays;
    std::vector<std::vector<std::uint32_t>> expected;
    for (std::uint32_t k = 0; k < 3; ++k) {
      std::mt19937 random(count + k);
      std::vector<std::uint32_t> values(count);
      for (auto& value : values) value = static_cast<std::uint32_t>(random());
      data.push_back(Buffer::of<std::uint32_t>(device, count, Memory::device, "values"));
      upload(device, data.back(), values);
      arrays.push_back({data.back().address(), scratch.address() + k * scratchBytes});
      std::exclusive_scan(values.begin(), values.end(), values.begin(), 0u);
      expected.push_back(std::move(values));
    }
    CommandList list(device, device.latencyQueue(), "scan");
    list.begin();
    scan.record(list, arrays, count);
    list.end();
    device.latencyQueue().run(list);
    for (std::size_t k = 0; k < 3; ++k) CHECK(download<std::uint32_t>(device, data[k], count) == expected[k]);
  }
}

TEST_SUITE_END();

}  // namespace palpate::prefix_scan_test
