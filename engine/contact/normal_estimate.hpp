// Normals on the GPU for clouds without normals.
#pragma once

#include <optional>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/up.hpp"
#include "engine/gpu/command_list.hpp"
#include "shaders/shared/spatial_hash.h"

namespace palpate {

/// Fits a plane to the neighbours of every point of an indexed cloud, weighted by Wendland's function of the distance
/// (Hoppe et al. 1992, section 3.2), gives points next to an edge the normal of their own face (keepEdges() of
/// engine/cloud), and records the nearest neighbours in all directions, along which signs propagate.
class NormalEstimate {
 public:
  /// Capacity: `points` points.
  NormalEstimate(Device& device, std::uint32_t points);

  /// `radius`: support radius, model units, increased or reduced where it contains very few or very many points.
  void record(CommandList& list, const shared::CloudView& cloud, double radius) const;

  // Indexed by the points' ids.
  const Buffer& planes() const { return planes_; }          ///< vec4: unit normal of either sign, or zero; radius
  const Buffer& fits() const { return fits_; }              ///< vec2: as FittedPlane::off; the spacing squared
  const Buffer& normals() const { return normals_; }        ///< vec4: unit, of either sign; undefined without a plane
  const Buffer& neighbours() const { return neighbours_; }  ///< kGraphSectors words

 private:
  ComputePipeline fit_, keepEdges_, name_;
  Buffer planes_, fits_, normals_, neighbours_;
};

/// Breakdown of the cost of an estimate.
struct NormalEstimateCost {
  double passes_ms = 0;    ///< index and passes on the GPU
  double planes_ms = 0;    ///< distinct positions, spacing, upload, passes, download, and planes on the CPU
  double signs_ms = 0;     ///< on the CPU
  std::size_t onHost = 0;  ///< distinct points whose planes the CPU fitted: isolated, crowded, or on a line
};

/// Gives every point of `cloud` a unit normal: planes from the GPU, over a support radius of kSupportSpacings; those it
/// leaves, from the CPU (fitNearestPlanes()); signs on the CPU (orientNormals()), propagated from plane to plane.
/// Coincident points count once. Agrees with estimateNormals() of engine/cloud except for the choice of neighbourhoods.
/// `up`: of the user; empty: findUp().
/// Throws OutOfGpuMemory; then the cloud is as before.
NormalEstimateCost estimateNormals(Device& device, PointCloud& cloud, unsigned threads = 0,
                                   std::optional<UpAxis> up = {});

}  // namespace palpate
