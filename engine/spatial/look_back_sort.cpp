#include "engine/spatial/look_back_sort.hpp"

#include <algorithm>
#include <utility>

#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/look_back_sort.h"

namespace palpate {

namespace {

constexpr std::uint32_t kHistogramWorkgroup = 256;
constexpr std::uint64_t kWord = sizeof(std::uint32_t);
// The scratch begins with the next tile of each pass, then the histograms, then the tiles' words of each pass.
constexpr std::uint64_t kHistogramsAt = shared::kSortMaxPasses * kWord;
constexpr std::uint64_t kTilesAt = kHistogramsAt + shared::kSortMaxPasses * shared::kSortRadix * kWord;

}  // namespace

bool canLookBack(const Device& device) { return device.driverId() == VK_DRIVER_ID_NVIDIA_PROPRIETARY; }

LookBackSort::LookBackSort(Device& device, std::uint32_t keyBits, const Shape& shape)
    : keyBits_(keyBits),
      digits_(radixDigits(keyBits)),
      shape_(shape),
      histogram_(device, shader_code::spatial_look_back_histogram,
                 {.workgroupSize = kHistogramWorkgroup, .pushBytes = sizeof(shared::RadixHistogramArgs)}) {
  PALPATE_CHECK(fits(device, keyBits, shape));
  PALPATE_CHECK_LE(shared::kSortRadix, shape.workgroup);  // one invocation for each digit
  for (const RadixDigit& digit : digits_)
    sweeps_.emplace_back(
        device, shader_code::spatial_look_back_sweep,
        PipelineOptions{.workgroupSize = shape.workgroup,
                        .pushBytes = sizeof(shared::RadixSweepArgs),
                        .constants = {shape.workgroup / device.subgroupSize(), shape.items, digit.bits}});
}

bool LookBackSort::fits(const Device& device, std::uint32_t keyBits, const Shape& shape) {
  std::uint32_t radix = 0;
  for (const RadixDigit& digit : radixDigits(keyBits)) radix = std::max(radix, 1u << digit.bits);
  const std::uint32_t subgroups = shape.workgroup / device.subgroupSize();
  const std::uint32_t pool = std::max(subgroups * radix, shape.workgroup * shape.items);
  constexpr std::uint32_t kRest = 512;  // the workgroup's scan, and a few words
  return (pool + 2 * radix) * kWord + kRest <= device.properties().limits.maxComputeSharedMemorySize;
}

std::uint64_t LookBackSort::tilesFor(std::uint64_t count) const {
  const std::uint64_t tile = std::uint64_t{shape_.workgroup} * shape_.items;
  return (count + tile - 1) / tile;
}

std::uint64_t LookBackSort::scratchBytes(std::uint64_t count) const {
  std::uint64_t bytes = kTilesAt;
  for (const RadixDigit& digit : digits_) bytes += tilesFor(count) * kWord << digit.bits;
  return bytes;
}

PairSort::Sorted LookBackSort::record(CommandList& list, const Io& io, std::uint32_t count) const {
  PALPATE_CHECK_LE(count, shared::kSweepCountMask);
  PALPATE_CHECK_LE(scratchBytes(count), io.scratch.bytes());
  Sorted from{io.keys, io.values}, to{io.keysAlt, io.valuesAlt};
  if (digits_.empty() || count == 0) return from;
  list.fill(io.scratch, 0, scratchBytes(count));
  const DeviceAddress scratch = io.scratch.address();
  list.dispatch(histogram_, (std::uint64_t{count} + shared::kSweepHistogramItems - 1) / shared::kSweepHistogramItems,
                shared::RadixHistogramArgs{.keys = io.keys,
                                           .histograms = scratch + kHistogramsAt,
                                           .count = count,
                                           .passes = static_cast<std::uint32_t>(digits_.size()),
                                           .keyBits = keyBits_,
                                           .unused = 0});
  DeviceAddress tiles = scratch + kTilesAt;
  for (std::size_t pass = 0; pass < digits_.size(); ++pass) {
    list.dispatch(sweeps_[pass], tilesFor(count) * shape_.workgroup,
                  shared::RadixSweepArgs{.keysIn = from.keys,
                                         .valuesIn = from.values,
                                         .keysOut = to.keys,
                                         .valuesOut = to.values,
                                         .histogram = scratch + kHistogramsAt + pass * shared::kSortRadix * kWord,
                                         .nextTile = scratch + pass * kWord,
                                         .tiles = tiles,
                                         .count = count,
                                         .shift = digits_[pass].shift});
    tiles += tilesFor(count) * kWord << digits_[pass].bits;
    std::swap(from, to);
  }
  return from;
}

}  // namespace palpate
