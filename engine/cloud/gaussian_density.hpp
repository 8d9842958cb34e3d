// The density of Gaussians, sum(opacity exp(-d^2 / 2)), d being the distance in deviations: single precision, sixteen
// Gaussians at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/cloud/eigen3.hpp"
#include "engine/cloud/gaussian_discs.hpp"

namespace palpate {

/// What the density asks of a Gaussian. Lengths in usual radii.
struct FeltGaussian {
  FeltGaussian() = default;
  explicit FeltGaussian(const GaussianDisc& disc);

  Vec3 center{0};
  float opacity = 0;
  float xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;  ///< its precision, the inverse of its covariance
  Vec3 color{0};                                         ///< 0 to 1
  Vec3 reach{0};                                         ///< as of the disc
};

/// Of the Gaussians near some place. Lengths in usual radii. One thread at a time fills it; then any number asks.
class GaussianDensity {
 public:
  /// With those `gaussians` whose numbers are in `chosen`, and no others.
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
  /// For a place where there is any density at all.
  Curvature curvatureAt(const Vec3& p) const;

  struct Behind {
    float depth = 0;  ///< of the Gaussians' middles, each counting by its density and by how thin it is that way
    Vec3 color{0};    ///< each counting by its density; 0 to 1
  };
  /// What of the Gaussians that are felt at `p` is along `-normal` from it. For a place where there are any.
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
