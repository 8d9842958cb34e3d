#pragma once

#include "engine/spatial/pair_sort.hpp"

namespace palpate {

/// LSD radix sort that reads and writes every pair once per digit ("onesweep", Adinets and Merrill 2022). Workgroups
/// wait for earlier ones, so it requires a driver that guarantees progress of started workgroups: see canLookBack().
class LookBackSort final : public PairSort {
 public:
  LookBackSort(Device& device, std::uint32_t keyBits);
  /// Whether a workgroup's tile, and a histogram for each of its subgroups, fit the device's shared memory.
  static bool fits(const Device& device, std::uint32_t keyBits);

  std::uint64_t scratchBytes(std::uint64_t count) const override;
  /// `count` below 2^30.
  Sorted record(CommandList& list, const Io& io, std::uint32_t count) const override;

 private:
  struct Sweep {
    RadixDigit digit;
    ComputePipeline pipeline;
  };

  ComputePipeline histogram_;
  std::vector<Sweep> sweeps_;
};

/// Whether workgroups of this device may wait for earlier ones. True only for drivers known to allow it, never for a
/// software driver.
bool canLookBack(const Device& device);

}  // namespace palpate
