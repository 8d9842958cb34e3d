// The Gaussians of a scene that a surface can be made of, as solid discs around its middle.
#pragma once

#include <cstddef>

#include "engine/cloud/gaussian_scene.hpp"
#include "engine/core/bare_vector.hpp"

namespace palpate {

/// Lengths in usual radii.
struct GaussianDisc {
  Vec3 center{0};
  float opacity = 0;
  Vec3 longest{0}, middle{0}, shortest{0};  ///< deviations along its axes; perpendicular
  Vec3 color{0};                            ///< 0 to 1
  Vec3 reach{0};  ///< half the sides of the box outside of which its density is below 0.02, and not felt

  float area() const;  ///< of the ellipse within one deviation
};

struct GaussianDiscs {
  BareVector<GaussianDisc> discs;                      ///< in the order of the scene
  DVec3 origin{0};                                     ///< where their zero is, model units
  double usualRadius = 0;                              ///< model units
  std::size_t faint = 0, oversized = 0, outlying = 0;  ///< Gaussians that are none
};

/// The usual radius is the median of sqrt(longest * middle), each counting by its opacity, since training leaves many
/// Gaussians that hardly show; but no less than makes the discs' mean area twice that of the usual one. No disc:
/// - faint: an opacity below 0.05, which a look passes nearly whole. Such haze fills the space before and behind
///   surfaces.
/// - oversized: longer than ten usual radii, as sky and far background are; or without any size that numbers can hold.
/// - outlying: farther than 500,000 usual radii from the middle of the scene.
/// A disc is between 0.2 and 1 usual radii thick: thinner ones would stand apart as the steps of a stair, thicker ones
/// are blurs of what is flat near by. The result does not depend on `threads` (0: one per core).
GaussianDiscs discsOf(const GaussianScene& scene, unsigned threads = 0);

}  // namespace palpate
