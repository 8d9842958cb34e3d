#include "engine/spatial/look_back_sort.hpp"

#include <algorithm>
#include <bit>
#include <optional>
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
// digits of up to seven bits fill that, and two with digits of eight. Smaller workgroups, and digits with fewer bits,
// are for devices with less.
constexpr std::uint32_t kSweepWorkgroups[]{384, 256};
constexpr std::uint32_t kFewestBits = 4;
std::uint32_t itemsFor(const RadixDigit& digit) { return digit.bits <= 7 ? 10 : 12; }

struct Shape {
  std::uint32_t workgroup = 0;
  std::vector<RadixDigit> digits;
};

bool fitsShared(const Device& device, const Shape& shape) {
  const std::uint32_t subgroups = shape.workgroup / device.subgroupSize();
  constexpr std::uint32_t kRest = 768;  // the workgroup's scan, and a few words
  return std::ranges::all_of(shape.digits, [&](const RadixDigit& digit) {
    const std::uint32_t radix = 1u << digit.bits;
    const std::uint32_t pool = std::max(subgroups * radix, shape.workgroup * itemsFor(digit));
    return (pool + radix) * kCounterBytes + kRest <= sharedBytes(device);
  });
}

std::optional<Shape> shapeFor(const Device& device, std::uint32_t keyBits) {
  for (std::uint32_t bits = shared::kSortMaxDigitBits; bits >= kFewestBits; --bits)
    for (const std::uint32_t workgroup : kSweepWorkgroups) {
      Shape shape{.workgroup = workgroup, .digits = radixDigits(keyBits, bits)};
      static_assert(shared::kSortRadix <= kSweepWorkgroups[1]);  // one invocation for each digit
      if (workgroup > device.widestWorkgroup() || workgroup % device.subgroupSize() != 0) continue;
      if (fitsShared(device, shape)) return shape;
    }
  return std::nullopt;
}

// Two workgroups of this size occupy all invocations of a processor, so that each may use half of its shared memory.
constexpr std::uint32_t kHistogramWorkgroup = 1024, kHistogramBytes = 24 * 1024;

PipelineOptions histogramOptions(const Device& device, std::uint32_t keyBits) {
  const std::vector<RadixDigit> digits = shapeFor(device, keyBits)->digits;
  const auto passes = static_cast<std::uint32_t>(std::max<std::size_t>(1, digits.size()));
  const std::uint32_t mostBits = digits.empty() ? 1 : digits.front().bits;  // the longer ones are first
  const std::uint64_t counters = std::min(kHistogramBytes, sharedBytes(device)) / kCounterBytes;
  const auto copies =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(32, std::bit_floor(counters / passes >> mostBits)));
  return {.workgroupSize = std::min(kHistogramWorkgroup, std::bit_floor(device.widestWorkgroup())),
          .pushBytes = sizeof(shared::RadixHistogramArgs),
          .constants = {keyBits, passes, mostBits, copies}};
}

}  // namespace

bool prefersLookBack(const Device& device) { return device.driverId() == VK_DRIVER_ID_NVIDIA_PROPRIETARY; }

LookBackSort::LookBackSort(Device& device, std::uint32_t keyBits, const LookBackOptions& options)
    : histogram_(device, shader_code::spatial_look_back_histogram, histogramOptions(device, keyBits)) {
  const Shape shape = *shapeFor(device, keyBits);
  PALPATE_CHECK_LE(shape.digits.size(), std::size_t{shared::kSortMaxPasses});
  for (const RadixDigit& digit : shape.digits)
    sweeps_.push_back({digit, ComputePipeline(device, shader_code::spatial_look_back_sweep,
                                              {.workgroupSize = shape.workgroup,
                                               .pushBytes = sizeof(shared::RadixSweepArgs),
                                               .constants = {shape.workgroup / device.subgroupSize(), itemsFor(digit),
                                                             digit.bits, options.mostLooks, options.silent}})});
}

bool LookBackSort::fits(const Device& device, std::uint32_t keyBits) { return shapeFor(device, keyBits).has_value(); }

std::uint64_t LookBackSort::Sweep::tiles(std::uint64_t count) const {
  const std::uint64_t tile = std::uint64_t{pipeline.workgroupSize()} * itemsFor(digit);
  return (count + tile - 1) / tile;
}

std::uint64_t LookBackSort::Sweep::tileBytes(std::uint64_t count) const {
  return tiles(count) * kCounterBytes << digit.bits;
}

std::uint64_t LookBackSort::scratchBytes(std::uint64_t count) const {
  std::uint64_t bytes = kTilesAt;
  for (const Sweep& sweep : sweeps_) bytes += sweep.tileBytes(count);
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
    const Sweep& sweep = sweeps_[pass];
    list.dispatch(
        sweep.pipeline, sweep.tiles(count) * sweep.pipeline.workgroupSize(),
        shared::RadixSweepArgs{.keysIn = from.keys,
                               .valuesIn = from.values,
                               .keysOut = to.keys,
                               .valuesOut = to.values,
                               .histogram = scratch + kHistogramsAt + pass * shared::kSortRadix * kCounterBytes,
                               .nextTile = scratch + pass * kCounterBytes,
                               .tiles = tiles,
                               .count = count,
                               .shift = sweep.digit.shift});
    tiles += sweep.tileBytes(count);
    std::swap(from, to);
  }
  return from;
}

}  // namespace palpate
