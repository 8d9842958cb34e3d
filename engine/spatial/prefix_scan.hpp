#pragma once

#include <span>

#include "engine/gpu/command_list.hpp"

namespace palpate {

/// Exclusive prefix sum of 32-bit values in place, modulo 2^32: reduce, then scan (Merrill and Grimshaw 2009, section
/// 3). Workgroups do not wait for each other, so it runs on every driver.
class PrefixScan {
 public:
  explicit PrefixScan(Device& device);

  struct Io {
    DeviceAddress values;   ///< `count` uint32
    DeviceAddress scratch;  ///< scratchBytes(count)
  };
  static std::uint64_t scratchBytes(std::uint64_t count);
  void record(CommandList& list, const Io& io, std::uint32_t count) const;
  /// The same for several arrays of `count` values, each with its own scratch, in parallel.
  void record(CommandList& list, std::span<const Io> arrays, std::uint32_t count) const;

 private:
  ComputePipeline reduce_, scan_;
};

/// The same of counts, into ranges: `ranges` receives the first and one-past-last index of each of `count` values
/// (uvec2); the counts become zero.
class RangeScan {
 public:
  explicit RangeScan(Device& device);

  void record(CommandList& list, const PrefixScan::Io& io, DeviceAddress ranges, std::uint32_t count) const;

 private:
  ComputePipeline reduce_, ranges_;
};

}  // namespace palpate
