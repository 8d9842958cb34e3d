#pragma once

#include <array>
#include <map>
#include <memory>

#include "engine/motion/fusion_pass.hpp"
#include "engine/motion/icp.hpp"

namespace palpate {

/// Finds the pose of a frame in a map on the GPU, as findPose() does on the host: pairs are found and summed up there,
/// and the equations are solved here. The same points and frame give the same pose.
class PoseSearchPass {
 public:
  /// `fusion`, whose frames are looked for, must outlive it, and so must `cloud`. `queue`: on which it runs. Throws
  /// OutOfGpuMemory.
  PoseSearchPass(Device& device, Queue& queue, FusionPass& fusion, const LiveCloud& cloud);

  /// The pose from which `images`, which were put into the fusion pass, lie on the front half of the cloud, about
  /// `expected`; `origin`: of the map in the world. Waits for its queue, once for each step, so it is for the thread
  /// that uses that. Nobody writes the half meanwhile. What is put has the expected pose then (FusionPass::setPose()).
  IcpResult find(const FrameImages& images, const CameraPose& expected, const DVec3& origin,
                 const IcpOptions& options = {});

  /// On the GPU.
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
  std::array<std::unique_ptr<CommandList>, 2> fronts_;            // by the half that is front
  std::map<std::uint32_t, std::unique_ptr<CommandList>> levels_;  // by stride
};

}  // namespace palpate
