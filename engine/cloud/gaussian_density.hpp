// The density of Gaussians, sum(opacity exp(-d^2 / 2)), d being the distance in deviations: single precision, eight
// Gaussians at a time.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "engine/cloud/eigen3.hpp"
#include "engine/cloud/gaussian_discs.hpp"

namespace palpate {

/// Of the Gaussians near some place. Lengths in usual radii. One thread at a time fills it; then any number asks.
class GaussianDensity {
 public:
  void clear();
  void add(const GaussianDisc& disc);

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

  /// How far along `-normal` from `p` the Gaussians have their middles, each counting by how much it is felt at `p`: by
  /// its density and by how thin it is that way.
  float depthOfMiddles(const Vec3& p, const Vec3& normal) const;
  /// Of the Gaussians at a place where there is any, by their density; 0 to 1.
  Vec3 colorAt(const Vec3& p) const;

 private:
  enum Column : std::size_t { kX, kY, kZ, kOpacity, kXX, kYY, kZZ, kXY, kXZ, kYZ, kRed, kGreen, kBlue, kColumns };

  static constexpr std::size_t kLanes = 8;
  using Lanes = std::array<float, kLanes>;
  struct Block {
    std::array<Lanes, kColumns> columns;
  };
  struct Felt;
  template <class Use>
  void forEach(const Vec3& p, Use&& use) const;

  std::vector<Block> blocks_;
  std::size_t count_ = 0;
};

/// Half the sides of the box outside of which a Gaussian is too little to be added: its density is below 0.01 there.
Vec3 reachOf(const GaussianDisc& disc);

}  // namespace palpate
