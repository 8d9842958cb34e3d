#pragma once

#include "engine/study/bucket_passes.hpp"

namespace palpate {

/// Naive dynamic parallelism (thesis section 4.3.3): a launch for each bucket, of as many threads as the bucket has
/// points. In Vulkan: an indirect dispatch for every possible cell, recorded ahead, whose size the plan writes.
class GatherNaive final : public Gather {
 public:
  GatherNaive(Device& device, std::uint32_t cells);
  std::uint64_t slots() const override { return passes_.slots(); }
  void record(CommandList& list, std::uint32_t submission, const GatherIo& io) const override;

 private:
  BucketPasses passes_;
  Buffer commands_;
};

}  // namespace palpate
