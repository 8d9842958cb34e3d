#pragma once

#include "engine/study/bucket_passes.hpp"

namespace palpate {

/// Array-based dynamic parallelism (thesis section 4.3.3): the GPU lists the occupied buckets and makes one launch,
/// with a workgroup for each.
class GatherIndirect final : public Gather {
 public:
  GatherIndirect(Device& device, std::uint32_t cells);
  std::uint64_t slots() const override { return passes_.slots(); }
  void record(CommandList& list, std::uint32_t submission, const GatherIo& io) const override;

 private:
  BucketPasses passes_;
  Buffer command_;
};

}  // namespace palpate
