#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/spatial/prefix_scan.hpp"

namespace palpate {

/// Stable LSD radix sort of (key, value) pairs of 32 bits each, over the low `keyBits` bits of the key only: count,
/// scan, scatter per digit (Merrill and Grimshaw 2011). Portable: no workgroup waits for another, any subgroup size.
class RadixSort {
 public:
  explicit RadixSort(Device& device);

  struct Io {
    DeviceAddress keys, values;        ///< `count` uint32 each; in, and overwritten
    DeviceAddress keysAlt, valuesAlt;  ///< as large
    DeviceAddress scratch;             ///< scratchBytes(count)
  };
  struct Sorted {
    DeviceAddress keys, values;  ///< whichever of the two pairs holds the result
  };
  std::uint64_t scratchBytes(std::uint64_t count) const { return scratchBytes(count, workgroup_); }
  static std::uint64_t scratchBytes(std::uint64_t count, std::uint32_t workgroup);
  Sorted record(CommandList& list, const Io& io, std::uint32_t count, std::uint32_t keyBits) const;

 private:
  std::uint32_t workgroup_;
  PrefixScan scan_;
  ComputePipeline count_, scatter_;
};

}  // namespace palpate
