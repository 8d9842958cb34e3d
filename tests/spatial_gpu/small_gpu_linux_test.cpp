// Sorts on a GPU with small workgroups and little shared memory.
#include <algorithm>
#include <numeric>
#include <random>

#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/spatial/look_back_sort.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/lost_gpu/lost_gpu.hpp"

namespace palpate::small_gpu_test {

TEST_SUITE_BEGIN(kPortable);

TEST_CASE("a GPU with small workgroups and 16 KiB of shared memory sorts with look-back") {
  const LostGpuLayer layer(kMinGpu);
  Device device({.gpu = "", .validation = askedCoreValidation()});
  constexpr std::uint32_t kCount = 20'011, kBits = 12;
  std::mt19937 random(3);
  std::vector<std::uint32_t> keys(kCount), order(kCount);
  for (std::uint32_t& key : keys) key = static_cast<std::uint32_t>(random());
  std::iota(order.begin(), order.end(), 0u);
  REQUIRE(LookBackSort::fits(device, kBits));
  const LookBackSort sort(device, kBits);
  const auto words = [&](const char* name) { return deviceWords(device, kCount, name); };
  const Buffer from = words("keys"), to = words("keys alt"), values = words("values"), valuesTo = words("values alt");
  const Buffer scratch(device, sort.scratchBytes(kCount), Memory::device, "scratch");
  upload(device, from, keys);
  upload(device, values, order);
  CommandList list(device, device.latencyQueue(), "sort");
  list.begin();
  const auto sorted =
      sort.record(list, {from.address(), values.address(), to.address(), valuesTo.address(), scratch}, kCount);
  list.end();
  device.latencyQueue().run(list);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return keys[i] % (1u << kBits); });
  CHECK(download<std::uint32_t>(device, sorted.values == values.address() ? values : valuesTo, kCount) == order);
  CHECK(device.instance().messages().take().empty());
}

TEST_SUITE_END();

}  // namespace palpate::small_gpu_test
