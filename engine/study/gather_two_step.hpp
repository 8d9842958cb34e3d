#pragma once

#include "engine/study/bucket_passes.hpp"

namespace palpate {

/// Two steps (thesis section 4.3.2): a first submission counts the points of the buckets; the host reads the largest
/// count and launches buckets x largest count threads with a second one, recorded ahead like the first.
class GatherTwoStep final : public Gather {
 public:
  GatherTwoStep(Device& device, std::uint32_t cells);
  std::uint64_t slots() const override { return passes_.slots(); }
  std::uint32_t submissions() const override { return 2; }
  void record(CommandList& list, std::uint32_t submission, const GatherIo& io) const override;
  void resume() const override;

 private:
  BucketPasses passes_;
  Buffer counts_, command_;
};

}  // namespace palpate
