// Compliance of a soft body on a GPU.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/compute_pipeline.hpp"
#include "engine/matter/soft_passes.hpp"

namespace palpate {

class Queue;

/// Conjugate gradients as in SoftWorld, in single precision. An iteration is eight passes over the body.
class GpuSoftCompliance {
 public:
  /// All arguments must outlive it. `hold_1_s2`: stiffness per mass that holds an otherwise free body. Throws
  /// OutOfGpuMemory.
  GpuSoftCompliance(Device& device, Queue& queue, const SoftMemory& memory, const SoftSizes& sizes, double hold_1_s2);

  /// The load times the displacement of the nodes under it, N m. `load`: per node, N; pinned nodes must have none.
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
