#include "engine/spatial/look_back_sort.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/look_back_sort.h"

namespace palpate {

namespace {

constexpr std::uint64_t kCounterBytes = sizeof(std::uint32_t);
// Layout of the scratch: the next tile of each pass, then the histograms, then the tiles' words of each pass.
constexpr std::uint64_t kHistogramsAt = shared::kSortMaxPasses * kCounterBytes;
constexpr std::uint64_t kTilesAt = kHistogramsAt + shared::kSortMaxPasses * shared::kSortRadix * kCounterBytes;

// One workgroup sorts a tile. The speed depends on the number of keys in flight on a processor of the GPU, in several
// workgroups that hide each other's latency, which is limited by shared memory: NVIDIA's Vulkan driver gives all
// workgroups of a processor 48 KiB together (measured on an H200, whose processors have 228). Three workgroups with
// digits of up to seven bits fill that, and two with digits of eight.
constexpr std::uint32_t kSweepWorkgroup = 384;
std::uint32_t itemsFor(const RadixDigit& digit) { return digit.bits <= 7 ? 10 : 12; }

std::uint64_t tilesFor(const RadixDigit& digit, std::uint64_t count) {
  const std::uint64_t tile = std::uint64_t{kSweepWorkgroup} * itemsFor(digit);
  return (count + tile - 1) / tile;
}

std::uint64_t tileBytes(const RadixDigit& digit, std::uint64_t count) {
  return tilesFor(digit, count) * kCounterBytes << digit.bits;
}

constexpr std::uint32_t kHistogramWorkgroup = 1024, kHistogramBytes = 24 * 1024;

PipelineOptions histogramOptions(std::uint32_t keyBits) {
  const std::vector<RadixDigit> digits = radixDigits(keyBits);
  const auto passes = static_cast<std::uint32_t>(std::max<std::size_t>(1, digits.size()));
  const std::uint32_t mostBits = digits.empty() ? 1 : digits.front().bits;  // the longer ones are first
  // Two workgroups occupy all invocations of a processor, so that each may use half of its shared memory.
  constexpr std::uint32_t kMaxCounters = kHistogramBytes / kCounterBytes;
  const std::uint32_t copies = std::min(32u, std::bit_floor((kMaxCounters / passes) >> mostBits));
  return {.workgroupSize = kHistogramWorkgroup,
          .pushBytes = sizeof(shared::RadixHistogramArgs),
          .constants = {keyBits, passes, mostBits, copies}};
}

}  // namespace

bool canLookBack(const Device& device) { return device.driverId() == VK_DRIVER_ID_NVIDIA_PROPRIETARY; }

LookBackSort::LookBackSort(Device& device, std::uint32_t keyBits)
    : histogram_(device, shader_code::spatial_look_back_histogram, histogramOptions(keyBits)) {
  PALPATE_CHECK(fits(device, keyBits));
  static_assert(shared::kSortRadix <= kSweepWorkgroup);  // one invocation for each digit
  for (const RadixDigit& digit : radixDigits(keyBits))
    sweeps_.push_back({digit, ComputePipeline(device, shader_code::spatial_look_back_sweep,
                                              {.workgroupSize = kSweepWorkgroup,
                                               .pushBytes = sizeof(shared::RadixSweepArgs),
                                               .constants = {kSweepWorkgroup / device.subgroupSize(), itemsFor(digit),
                                                             digit.bits}})});
}

bool LookBackSort::fits(const Device& device, std::uint32_t keyBits) {
  if (device.subgroupSize() > 32) return false;  // one word holds a subgroup's ballot
  if (widestWorkgroup(device) < kHistogramWorkgroup || sharedBytes(device) < kHistogramBytes) return false;
  const std::uint32_t subgroups = kSweepWorkgroup / device.subgroupSize();
  constexpr std::uint32_t kRest = 768;  // the workgroup's scan, and a few words
  return std::ranges::all_of(radixDigits(keyBits), [&](const RadixDigit& digit) {
    const std::uint32_t radix = 1u << digit.bits;
    const std::uint32_t pool = std::max(subgroups * radix, kSweepWorkgroup * itemsFor(digit));
    return (pool + radix) * kCounterBytes + kRest <= sharedBytes(device);
  });
}

std::uint64_t LookBackSort::scratchBytes(std::uint64_t count) const {
  std::uint64_t bytes = kTilesAt;
  for (const Sweep& sweep : sweeps_) bytes += tileBytes(sweep.digit, count);
  return bytes;
}

PairSort::Sorted LookBackSort::record(CommandList& list, const Io& io, std::uint32_t count) const {
  PALPATE_CHECK_LE(count, shared::kSweepCountMask);
  PALPATE_CHECK_LE(scratchBytes(count), io.scratch.bytes());
  Sorted from{io.keys, io.values}, to{io.keysAlt, io.valuesAlt};
  if (sweeps_.empty() || count == 0) return from;
  list.fill(io.scratch, 0, scratchBytes(count));
  const DeviceAddress scratch = io.scratch.address();
  list.dispatch(
      histogram_, (std::uint64_t{count} + shared::kSweepHistogramItems - 1) / shared::kSweepHistogramItems,
      shared::RadixHistogramArgs{.keys = io.keys, .histograms = scratch + kHistogramsAt, .count = count, .unused = 0});
  DeviceAddress tiles = scratch + kTilesAt;
  for (std::size_t pass = 0; pass < sweeps_.size(); ++pass) {
    const RadixDigit& digit = sweeps_[pass].digit;
    list.dispatch(
        sweeps_[pass].pipeline, tilesFor(digit, count) * kSweepWorkgroup,
        shared::RadixSweepArgs{.keysIn = from.keys,
                               .valuesIn = from.values,
                               .keysOut = to.keys,
                               .valuesOut = to.values,
                               .histogram = scratch + kHistogramsAt + pass * shared::kSortRadix * kCounterBytes,
                               .nextTile = scratch + pass * kCounterBytes,
                               .tiles = tiles,
                               .count = count,
                               .shift = digit.shift});
    tiles += tileBytes(digit, count);
    std::swap(from, to);
  }
  return from;
}

}  // namespace palpate
