#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Heights over a plane that bend as little as possible between given ones: a thin plate spline (Duchon 1977, "Splines
/// minimizing rotation-invariant semi-norms in Sobolev spaces"), smoothing as in Wahba 1990, "Spline models for
/// observational data", section 2.4. It continues slope and curvature of what surrounds a gap: quadratic and cubic
/// heights have no force of bending. Costs the third power of the number of heights to make.
class ThinPlate {
 public:
  /// `smoothing`: weight of the bending energy beside the sum of the squared differences, in the squared unit of `at`;
  /// must be positive where positions coincide.
  ThinPlate(std::span<const DVec2> at, std::span<const double> heights, double smoothing);

  double height(const DVec2& at) const;
  DVec2 slope(const DVec2& at) const;

 private:
  std::vector<DVec2> at_;
  std::vector<double> weights_;    // of at_
  std::array<double, 3> plane_{};  // constant, and of both coordinates
};

}  // namespace palpate
