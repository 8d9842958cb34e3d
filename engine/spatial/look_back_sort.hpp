#pragma once

#include "engine/spatial/pair_sort.hpp"

namespace palpate {

/// LSD radix sort that reads and writes every pair once a digit ("onesweep", Adinets and Merrill 2022). Workgroups wait
/// for earlier ones, so it is only for drivers on which a workgroup that has started goes on: see canLookBack().
class LookBackSort final : public PairSort {
 public:
  /// Size of a tile: a workgroup and its keys per invocation. Larger tiles look back less often and leave fewer
  /// workgroups to hide each other's waits.
  struct Shape {
    std::uint32_t workgroup = 256, items = 16;
  };
  LookBackSort(Device& device, std::uint32_t keyBits, const Shape& shape);
  LookBackSort(Device& device, std::uint32_t keyBits) : LookBackSort(device, keyBits, Shape{}) {}
  /// Whether a workgroup's histograms, one for each of its subgroups, fit the device's shared memory.
  static bool fits(const Device& device, std::uint32_t keyBits, const Shape& shape);
  static bool fits(const Device& device, std::uint32_t keyBits) { return fits(device, keyBits, Shape{}); }

  std::uint64_t scratchBytes(std::uint64_t count) const override;
  /// `count` below 2^30.
  Sorted record(CommandList& list, const Io& io, std::uint32_t count) const override;

 private:
  std::uint64_t tilesFor(std::uint64_t count) const;

  std::uint32_t keyBits_;
  std::vector<RadixDigit> digits_;
  Shape shape_;
  ComputePipeline histogram_;
  std::vector<ComputePipeline> sweeps_;  // one for each digit
};

/// Whether workgroups of this device may wait for earlier ones. True for the drivers of which it is known, never for a
/// software driver.
bool canLookBack(const Device& device);

}  // namespace palpate
