#include "apps/bench/bench.hpp"
#include "apps/bench/cub_times.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/spatial/radix_sort.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kKeys = 1 << 20, kKeyBits = 21;
constexpr double kCuda_s = 1;

// All keys are equal: the cost of this sort does not depend on them.
void sortFor(Device& device, double duration_s) {
  const auto words = [&](const char* name) { return Buffer::of<std::uint32_t>(device, kKeys, Memory::device, name); };
  const Buffer keys = words("keys"), values = words("values"), keysAlt = words("keys alt");
  const Buffer valuesAlt = words("values alt");
  const RadixSort sort(device, kKeyBits);
  const Buffer scratch(device, sort.scratchBytes(kKeys), Memory::device, "sort scratch");
  upload(device, keys, std::vector<std::uint32_t>(kKeys));
  upload(device, values, std::vector<std::uint32_t>(kKeys));
  CommandList list(device, device.latencyQueue(), "warm up");
  list.begin();
  sort.record(list, {keys.address(), values.address(), keysAlt.address(), valuesAlt.address(), scratch}, kKeys);
  list.end();
  for (const Stopwatch watch; watch.elapsed_s() < duration_s;) device.latencyQueue().run(list);
}

}  // namespace

void warmUp(Context& context, const BenchOptions& options) {
  if (options.wants("vulkan")) {
    const double duration_s = context.backends().named("vulkan").warmUp_s();
    if (!(duration_s > 0)) return;
    context.log().say("warming the GPU up for {:g} s", duration_s);
    sortFor(context.device(), duration_s);
  } else if (options.wants("cuda")) {
    const std::vector<std::uint32_t> keys(kKeys);
    for (const Stopwatch watch; watch.elapsed_s() < kCuda_s;) cubSortTimes_us(keys, kKeyBits, 20);
  }
}

}  // namespace palpate
