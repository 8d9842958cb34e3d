#pragma once

#include <array>
#include <map>
#include <memory>

#include "engine/motion/fusion_pass.hpp"
#include "engine/motion/icp.hpp"

namespace palpate {

/// Finds the pose of a frame in a map on the GPU, as findPose() does on the host: the GPU finds and sums up pairs, the
/// host solves the equations. The same points and frame give the same pose.
class PoseSearchPass {
 public:
  /// `fusion`, whose frames are searched for, and `cloud` must outlive the object; it runs on `queue`. Throws
  /// OutOfGpuMemory.
  PoseSearchPass(Device& device, Queue& queue, FusionPass& fusion, const LiveCloud& cloud);

  /// Pose in which `images`, which were put into the fusion pass, lie on the front half of the cloud, searched from
  /// `expected`; `origin`: of the map in the world. Blocks on its queue for each step, so it is for the queue's thread;
  /// the half must not be written meanwhile. Leaves the expected pose set in the pass (FusionPass::setPose()).
  IcpResult find(const FrameImages& images, const CameraPose& expected, const DVec3& origin,
                 const IcpOptions& options = {});

  /// GPU memory.
  std::uint64_t bytes() const;

 private:
  const CommandList& frontOf(std::uint32_t half);
  const CommandList& listFor(std::uint32_t stride);
  IcpSums sum(const IcpQuery& query, const DVec3& origin);

  Device& device_;
  Queue& queue_;
  FusionPass& fusion_;
  const LiveCloud& cloud_;
  ComputePipeline frontPass_, sumsPass_;
  Buffer query_, nearest_, ids_, frontPlaces_, frontNormals_, sums_;
  std::array<std::unique_ptr<CommandList>, 2> fronts_;            // by the front half
  std::map<std::uint32_t, std::unique_ptr<CommandList>> levels_;  // by stride
};

}  // namespace palpate
