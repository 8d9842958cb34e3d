// How far a soft body on a GPU gives way.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/compute_pipeline.hpp"
#include "engine/matter/soft_passes.hpp"

namespace palpate {

class Queue;

/// Conjugate gradients as SoftWorld has them, in single precision. A round is eight passes over the body.
class GpuSoftCompliance {
 public:
  /// All of them outlive it. `hold_1_s2`: what holds a body that nothing else does, for its mass. Throws
  /// OutOfGpuMemory.
  GpuSoftCompliance(Device& device, Queue& queue, const SoftMemory& memory, const SoftSizes& sizes, double hold_1_s2);

  /// The load times how far the nodes go under it, N m. `load`: of each node, N; those that are pinned have none.
  /// Waits.
  double give(const std::vector<Vec4>& load);
  std::uint64_t bytes() const;

 private:
  void record(double hold_1_s2);

  Device& device_;
  Queue& queue_;
  const SoftMemory& memory_;
  SoftSizes sizes_;
  ComputePipeline way_, trial_, cells_, answer_, descend_;
  Buffer trialNodes_, load_, vectors_, sums_, sumsRead_;
  CommandList begin_, rounds_;
};

}  // namespace palpate
