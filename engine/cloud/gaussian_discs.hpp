// The Gaussians of a scene that can form a surface, as solid discs around the scene's middle.
#pragma once

#include <cstddef>

#include "engine/cloud/gaussian_scene.hpp"
#include "engine/core/bare_vector.hpp"

namespace palpate {

/// Lengths in usual radii.
struct GaussianDisc {
  Vec3 center{0};
  float opacity = 0;
  Vec3 longest{0}, middle{0}, shortest{0};  ///< standard deviations along its axes; perpendicular
  Vec3 color{0};                            ///< 0 to 1
  Vec3 reach{0};  ///< half the sides of the box outside of which its density is below 0.02 and ignored

  float area() const;  ///< of the ellipse within one deviation
};

struct GaussianDiscs {
  BareVector<GaussianDisc> discs;                      ///< in the order of the scene
  DVec3 origin{0};                                     ///< position of the discs' origin, model units
  double usualRadius = 0;                              ///< model units
  std::size_t faint = 0, oversized = 0, outlying = 0;  ///< Gaussians that are not discs
};

/// The usual radius is the median of sqrt(longest * middle), weighted by opacity, since training leaves many nearly
/// invisible Gaussians; but at least so large that the discs' mean area is at most twice that of the usual one.
/// Excluded as:
/// - faint: an opacity below 0.05, nearly transparent. Such haze fills the space in front of and behind surfaces.
/// - oversized: longer than ten usual radii, as sky and far background are; or of a size that floats cannot hold.
/// - outlying: farther than 500,000 usual radii from the middle of the scene.
/// A disc is between 0.2 and 1 usual radii thick: thinner ones would stand apart like the steps of a stair, thicker
/// ones are blurs of flat surfaces near by. The result does not depend on `threads` (0: one per core).
GaussianDiscs discsOf(const GaussianScene& scene, unsigned threads = 0);

}  // namespace palpate
