// A surface that can be touched, of a scene of Gaussians.
#pragma once

#include "engine/cloud/gaussian_scene.hpp"
#include "engine/cloud/point_cloud.hpp"

namespace palpate {

struct GaussianSurface {
  PointCloud cloud;    ///< with normals, outwards, and colours; its points are about `spacing` apart everywhere
  double spacing = 0;  ///< model units: the usual radius of the Gaussians; 0: there is none that shows
  double level = 0;    ///< density that the surface was looked for at
  /// Gaussians that were left out: see discsOf().
  std::size_t faint = 0, oversized = 0, outlying = 0;
};

/// Follows the sheets that the Gaussians make up, wherever their density, sum(opacity exp(-d^2 / 2)), reaches a level
/// of 0.3 of what is usual in the scene (and of 0.2 to 1): from places all over the discs to the level's face that
/// looks outwards, along the gradient by Newton's method (the level as a surface and its gradient as normal: Guedon and
/// Lepetit 2024, "SuGaR"). That face stands in front of the discs by their thickness, so that each point then goes back
/// against its normal to where the Gaussians that are felt there have their middles. Places that get to no such face
/// are within what is thick, and make no point, nor do a few Gaussians that stand apart from all others. Normals are
/// means over the points near by, colours those of all Gaussians at a point, by their densities.
///
/// O(N), nearly all of it on all threads: a million Gaussians took four seconds of processor time.
/// The result does not depend on `threads` (0: one per core). Empty for a scene of which nothing shows.
GaussianSurface surfaceOf(const GaussianScene& scene, unsigned threads = 0);

}  // namespace palpate
