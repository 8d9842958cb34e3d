// The density of Gaussians, sum(opacity exp(-d^2 / 2)), with d the distance in standard deviations: single precision,
// sixteen Gaussians at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/cloud/eigen3.hpp"
#include "engine/cloud/gaussian_discs.hpp"

namespace palpate {

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
