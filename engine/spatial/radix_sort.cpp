#include "engine/spatial/radix_sort.hpp"

#include <algorithm>
#include <utility>

#include "engine/gpu/compute_pipeline.hpp"
#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/radix_sort.h"

namespace palpate {

namespace {

constexpr std::uint32_t kWord = sizeof(std::uint32_t);

// Shared memory holds a histogram for each subgroup, at most 16 of them, and the keys of each invocation.
std::uint32_t bytesFor(std::uint32_t workgroup, std::uint32_t subgroup) {
  constexpr std::uint32_t kPrefixScan = 256;
  const std::uint32_t histograms = std::max(1u, workgroup / subgroup) + 2;
  return kWord * (histograms * shared::kSortRadix + workgroup * shared::kSortItems) + kPrefixScan;
}
std::uint32_t workgroupFor(const Device& device) {
  const std::uint32_t size = device.subgroupSize();
  std::uint32_t workgroup = std::clamp(size <= 8 ? 16 * size : 8 * size, 64u, 256u);
  while (workgroup > 32 && bytesFor(workgroup, size) > sharedBytes(device)) workgroup /= 2;
  return workgroup;
}

std::uint64_t partitionsFor(std::uint64_t count, std::uint32_t workgroup) {
  const std::uint64_t partition = std::uint64_t{workgroup} * shared::kSortItems;
  return (count + partition - 1) / partition;
}

PipelineOptions options(std::uint32_t workgroup, std::vector<std::uint32_t> constants = {}) {
  return {.workgroupSize = workgroup, .pushBytes = sizeof(shared::RadixSortArgs), .constants = std::move(constants)};
}

}  // namespace

RadixSort::RadixSort(Device& device, std::uint32_t keyBits)
    : digits_(radixDigits(keyBits)),
      workgroup_(workgroupFor(device)),
      scan_(device),
      count_(device, shader_code::spatial_radix_sort_count, options(workgroup_)),
      scatter_(device, shader_code::spatial_radix_sort_scatter,
               options(workgroup_, {std::max(1u, workgroup_ / device.subgroupSize())})) {}

std::uint64_t RadixSort::scratchBytes(std::uint64_t count, std::uint32_t workgroup) {
  const std::uint64_t counters = partitionsFor(count, workgroup) * shared::kSortRadix;
  return counters * sizeof(std::uint32_t) + PrefixScan::scratchBytes(counters);
}

PairSort::Sorted RadixSort::record(CommandList& list, const Io& io, std::uint32_t count) const {
  PALPATE_CHECK_LE(scratchBytes(count), io.scratch.bytes());
  const auto partitions = static_cast<std::uint32_t>(partitionsFor(count, workgroup_));
  const DeviceAddress counts = io.scratch.address();
  const DeviceAddress scanScratch = counts + std::uint64_t{partitions} * shared::kSortRadix * sizeof(std::uint32_t);
  Sorted from{io.keys, io.values}, to{io.keysAlt, io.valuesAlt};
  for (const RadixDigit& digit : digits_) {
    const shared::RadixSortArgs args{.keysIn = from.keys,
                                     .valuesIn = from.values,
                                     .keysOut = to.keys,
                                     .valuesOut = to.values,
                                     .counts = counts,
                                     .count = count,
                                     .partitions = partitions,
                                     .shift = digit.shift,
                                     .digitBits = digit.bits};
    list.dispatch(count_, std::uint64_t{partitions} * workgroup_, args);
    scan_.record(list, {counts, scanScratch}, partitions << digit.bits);
    list.dispatch(scatter_, std::uint64_t{partitions} * workgroup_, args);
    std::swap(from, to);
  }
  return from;
}

}  // namespace palpate
