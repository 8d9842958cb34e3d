// A touchable surface from a scene of Gaussians.
#pragma once

#include "engine/cloud/gaussian_scene.hpp"
#include "engine/cloud/point_cloud.hpp"

namespace palpate {

struct GaussianSurface {
  PointCloud cloud;    ///< with outward normals and colours; its points are about `spacing` apart everywhere
  double spacing = 0;  ///< model units: the usual radius of the Gaussians; 0: none is visible
  double level = 0;    ///< density at which the surface was extracted
  /// Excluded Gaussians: see discsOf(). Also outlying: those beside the surface, farther from it than half its length.
  std::size_t faint = 0, oversized = 0, outlying = 0;
};

/// Follows the sheets that the Gaussians form, where their density, sum(opacity exp(-d^2 / 2)), reaches a level of 0.3
/// of the scene's usual density (clamped to 0.2 to 1): from positions all over the discs to the level's outward face,
/// along the gradient by Newton's method (the level as a surface and its gradient as normal: Guedon and Lepetit 2024,
/// "SuGaR"). That face lies in front of the discs by their thickness, so each point then moves back along its normal to
/// the centres of the Gaussians that contribute there. Positions that reach no such face are inside thick matter and
/// give no point, nor do small isolated groups of Gaussians. Normals are means over the near points, colours those of
/// all Gaussians at a point, weighted by density.
///
/// O(N), nearly all of it on all threads: a million Gaussians took four seconds of processor time. The result does not
/// depend on `threads` (0: one per core). Empty if no Gaussian of the scene is visible.
GaussianSurface surfaceOf(const GaussianScene& scene, unsigned threads = 0);

}  // namespace palpate
