// The density of Gaussians, sum(opacity exp(-d^2 / 2)), with d the distance in standard deviations: single precision,
// sixteen Gaussians at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/cloud/eigen3.hpp"
#include "engine/cloud/gaussian_scene.hpp"
#include "engine/core/bare_vector.hpp"

namespace palpate {

/// The Gaussians of a scene that can form a surface, as solid discs around the scene's middle.
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

/// The properties of a Gaussian that the density needs. Lengths in usual radii.
struct FeltGaussian {
  FeltGaussian() = default;
  explicit FeltGaussian(const GaussianDisc& disc);

  Vec3 center{0};
  float opacity = 0;
  float xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;  ///< its precision, the inverse of its covariance
  Vec3 color{0};                                         ///< 0 to 1
  Vec3 reach{0};                                         ///< as GaussianDisc::reach
};

/// Density of the Gaussians near a position. Lengths in usual radii. Filled by one thread; afterwards any number of
/// threads may query it.
class GaussianDensity {
 public:
  /// Contains only the `gaussians` whose numbers are in `chosen`.
  void fill(std::span<const FeltGaussian> gaussians, std::span<const std::uint32_t> chosen);

  float densityAt(const Vec3& p) const;
  struct Slope {
    float density = 0;
    Vec3 gradient{0};
  };
  Slope slopeAt(const Vec3& p) const;

  struct Curvature {
    float density = 0;
    Vec3 logGradient{0};         ///< of the density's logarithm
    SymmetricMatrix3 downwards;  ///< minus the second derivatives of the density's logarithm
  };
  /// Requires a position with nonzero density.
  Curvature curvatureAt(const Vec3& p) const;

  struct Behind {
    float depth = 0;  ///< of the Gaussians' centres, weighted by density and by thinness in that direction
    Vec3 color{0};    ///< weighted by density; 0 to 1
  };
  /// Depth along `-normal`, and colour, of the Gaussians that contribute at `p`. Requires a position with such
  /// Gaussians.
  Behind behind(const Vec3& p, const Vec3& normal) const;

 private:
  enum Column : std::size_t { kX, kY, kZ, kOpacity, kXX, kYY, kZZ, kXY, kXZ, kYZ, kRed, kGreen, kBlue, kColumns };

  static constexpr std::size_t kLanes = 16;
  using Lanes = std::array<float, kLanes>;
  struct alignas(sizeof(Lanes)) Block {
    std::array<Lanes, kColumns> columns;
  };
  struct Felt;
  template <class Use>
  void forEach(const Vec3& p, Use&& use) const;

  std::vector<Block> blocks_;
};

}  // namespace palpate
