#pragma once

#include <array>
#include <memory>

#include "engine/motion/fusion_pass.hpp"
#include "engine/motion/icp.hpp"

namespace palpate {

/// Finds the pose of a frame in a map on the GPU, as findPose() does on the host: pairs are found and summed up there,
/// and the equations are solved here. The same points and frame give the same pose.
class PoseSearchPass {
 public:
  /// `fusion`, whose frames are looked for, must outlive it, and so must `cloud`. Throws OutOfGpuMemory.
  PoseSearchPass(Device& device, FusionPass& fusion, const LiveCloud& cloud, const IcpOptions& options = {});

  /// The pose from which `images`, which were put into the fusion pass, lie on the front half of the cloud; `origin`:
  /// of the map in the world. Waits for the latency queue, once for each step. What is put has the expected pose then.
  /// `patience`: how many times the options' longest step and turn the camera may have moved.
  IcpResult find(const FrameImages& images, const CameraPose& expected, const DVec3& origin, double patience = 1);

  /// On the GPU.
  std::uint64_t bytes() const;

 private:
  void recordFront(std::uint32_t half);
  void recordLevel(std::size_t level);
  IcpSums sum(const IcpQuery& query, const DVec3& origin, std::size_t level) const;

  Device& device_;
  FusionPass& fusion_;
  const LiveCloud& cloud_;
  IcpOptions options_;
  ComputePipeline frontPass_, sumsPass_;
  Buffer query_, nearest_, ids_, frontPlaces_, frontNormals_, sums_;
  std::array<std::unique_ptr<CommandList>, 2> fronts_;  // by the half that is front
  std::array<std::unique_ptr<CommandList>, 3> levels_;
};

}  // namespace palpate
