#include <random>

#include "apps/bench/cub_times.hpp"
#include "apps/bench/times.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/spatial/look_back_sort.hpp"
#include "engine/spatial/radix_sort.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kKeyBits = 21;  // the buckets of the thesis's grid of 128 cells a side

std::vector<std::uint32_t> randomKeys(std::size_t count) {
  std::mt19937 random(1);
  std::vector<std::uint32_t> keys(count);
  for (auto& key : keys) key = static_cast<std::uint32_t>(random()) >> (32 - kKeyBits);
  return keys;
}

Summary measureVulkan(Device& device, const PairSort& sort, const std::vector<std::uint32_t>& keys,
                      const BenchOptions& options) {
  const auto count = static_cast<std::uint32_t>(keys.size());
  const auto words = [&](const char* name) { return Buffer::of<std::uint32_t>(device, count, Memory::device, name); };
  const Buffer unsorted = words("unsorted keys"), k = words("keys"), v = words("values");
  const Buffer kAlt = words("keys alt"), vAlt = words("values alt");
  const Buffer scratch(device, sort.scratchBytes(count), Memory::device, "sort scratch");
  upload(device, unsorted, keys);
  CommandList list(device, device.latencyQueue(), "sort", CommandList::Timing::sections);
  list.begin();
  // Restored outside the measured section; the values do not matter.
  list.copy(unsorted, k, k.bytes());
  list.copy(unsorted, v, v.bytes());
  {
    const auto section = list.section("sort");
    sort.record(list, {k.address(), v.address(), kAlt.address(), vAlt.address(), scratch}, count);
  }
  list.end();
  return measureSection(device, list, "sort", options);
}

}  // namespace

void benchSort(Context& context, const Subject& subject, const TimeBenchOptions& options,
               std::vector<BenchRecord>& records) {
  const auto keys = randomKeys(subject.model.cloud.size());
  const auto add = [&](const char* backend, const char* way, const Summary& gpu_us) {
    records.push_back({.bench = "sort",
                       .backend = backend,
                       .way = way,
                       .input = fmt::format("random keys of {} bits", kKeyBits),
                       .subject = "pairs",
                       .points = keys.size(),
                       .gpu_us = gpu_us,
                       .wall_us = {}});
  };
  if (options.wants("vulkan")) {
    Device& device = context.device();
    add("vulkan", "radix", measureVulkan(device, RadixSort(device, kKeyBits), keys, options));
    if (LookBackSort::fits(device, kKeyBits))
      add("vulkan", "radix-lookback", measureVulkan(device, LookBackSort(device, kKeyBits), keys, options));
  }
  if (options.wants("cuda"))
    add("cuda", "CUB", summarize(cubSortTimes_us(keys, kKeyBits, static_cast<int>(options.repeat))));
}

}  // namespace palpate
