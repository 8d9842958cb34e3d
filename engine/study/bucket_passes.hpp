#pragma once

#include "engine/contact/gather.hpp"

namespace palpate {

/// The two passes shared by the bucket methods: a plan of the cells around the probe, and the gather of planned cells.
/// The methods differ in how the second is launched, and how often.
class BucketPasses {
 public:
  /// `cells`: maximum number of cells that one gather visits.
  BucketPasses(Device& device, std::uint32_t cells);

  std::uint32_t cells() const { return cells_; }
  std::uint64_t slots() const;

  /// `plan`: a kPlan... of shaders/shared/gather.h, which defines the contents of `launch`.
  void recordPlan(CommandList& list, const GatherIo& io, std::uint32_t plan, const Buffer& launch) const;
  /// One row of workgroups for each cell from `firstCell` on; reads the indirect command in `groups` at `offset` bytes.
  void recordGather(CommandList& list, const GatherIo& io, const Buffer& groups, std::uint64_t offset = 0,
                    std::uint32_t firstCell = 0) const;

 private:
  std::uint32_t cells_;
  ComputePipeline plan_, gather_;
  Buffer planned_;
};

}  // namespace palpate
