// Normals for clouds that come without, on the GPU.
#pragma once

#include "engine/cloud/point_cloud.hpp"
#include "engine/gpu/command_list.hpp"
#include "shaders/shared/spatial_hash.h"

namespace palpate {

/// Fits a plane to the neighbours of every point of an indexed cloud, weighed by Wendland's function of the distance
/// (Hoppe et al. 1992, section 3.2), and names the nearest neighbours all around it, along which signs can be carried.
class NormalEstimate {
 public:
  explicit NormalEstimate(Device& device);

  /// `planes`: a vec4 for each point; `neighbours`: kSectors words for each point; both by the points' ids. `radius`:
  /// support radius, model units, widened or narrowed where it holds very few or very many points.
  void record(CommandList& list, const shared::CloudView& cloud, const Buffer& planes, const Buffer& neighbours,
              double radius) const;

 private:
  ComputePipeline fit_, name_;
};

/// Where the time of an estimate went.
struct NormalEstimateCost {
  double planes_ms = 0;    ///< upload, index, GPU pass and download
  double signs_ms = 0;     ///< on the CPU
  std::size_t onHost = 0;  ///< distinct points whose planes the CPU fitted: too far from others, too crowded, on a line
};

/// Gives every point of `cloud` a unit normal: planes from the GPU, over a support radius of kSupportSpacings; what it
/// leaves, from the CPU (fitNearestPlanes()); signs on the CPU (orientNormals()). Coincident points count once. Agrees
/// with estimateNormals() of engine/cloud up to how a neighbourhood is chosen. Throws OutOfGpuMemory.
NormalEstimateCost estimateNormals(Device& device, PointCloud& cloud, unsigned threads = 0);

}  // namespace palpate
