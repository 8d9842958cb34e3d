#pragma once

#include "engine/spatial/pair_sort.hpp"

namespace palpate {

struct LookBackOptions {
  /// Number of reads of an earlier tile whose count is missing, before a workgroup counts that tile itself.
  std::uint32_t mostLooks = 256;
  std::uint32_t silent = 0;  ///< for tests: if not 0, one tile in this many never publishes its count
};

/// LSD radix sort that reads and writes every pair once per digit ("onesweep", Adinets and Merrill 2022). Workgroups
/// wait for the counts of earlier ones, but not longer than it takes to count again ("decoupled fallback", Smith,
/// Levien and Owens 2025): it assumes no progress of other workgroups, and any subgroup size.
class LookBackSort final : public PairSort {
 public:
  /// Requires fits().
  LookBackSort(Device& device, std::uint32_t keyBits, const LookBackOptions& options = {});
  /// Whether a workgroup's tile, and a histogram for each of its subgroups, fit the device's shared memory.
  static bool fits(const Device& device, std::uint32_t keyBits);

  std::uint64_t scratchBytes(std::uint64_t count) const override;
  /// `count` below 2^30.
  Sorted record(CommandList& list, const Io& io, std::uint32_t count) const override;

 private:
  struct Sweep {
    RadixDigit digit;
    ComputePipeline pipeline;

    std::uint64_t tiles(std::uint64_t count) const;
    std::uint64_t tileBytes(std::uint64_t count) const;
  };

  ComputePipeline histogram_;
  std::vector<Sweep> sweeps_;
};

/// Whether this is the faster of the two radix sorts, as measured: on NVIDIA's driver.
bool prefersLookBack(const Device& device);

}  // namespace palpate
