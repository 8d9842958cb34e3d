#pragma once

#include "engine/spatial/pair_sort.hpp"
#include "engine/spatial/prefix_scan.hpp"

namespace palpate {

/// LSD radix sort: count, scan, scatter per digit (Merrill and Grimshaw 2011). Portable: workgroups do not wait for
/// each other, any subgroup size.
class RadixSort final : public PairSort {
 public:
  RadixSort(Device& device, std::uint32_t keyBits);

  std::uint64_t scratchBytes(std::uint64_t count) const override { return scratchBytes(count, workgroup_); }
  static std::uint64_t scratchBytes(std::uint64_t count, std::uint32_t workgroup);
  Sorted record(CommandList& list, const Io& io, std::uint32_t count) const override;

 private:
  std::vector<RadixDigit> digits_;
  std::uint32_t workgroup_;
  PrefixScan scan_;
  ComputePipeline count_, scatter_;
};

}  // namespace palpate
