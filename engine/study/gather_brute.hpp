#pragma once

#include "engine/contact/gather.hpp"

namespace palpate {

/// Brute force (thesis section 4.3.1): visits every point of the cloud and needs no index.
class GatherBrute final : public Gather {
 public:
  /// `points`: maximum number of points of the cloud. `mostPoints`: capacity of a patch; more points in reach are
  /// subsampled.
  GatherBrute(Device& device, std::uint32_t points, std::uint32_t mostPoints);
  std::uint64_t slots() const override;
  void record(CommandList& list, std::uint32_t submission, const GatherIo& io) const override;

 private:
  std::uint32_t points_, mostPoints_;
  ComputePipeline gather_, sum_;
  Buffer starts_;
};

}  // namespace palpate
