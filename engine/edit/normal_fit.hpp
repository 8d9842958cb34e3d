// The computation of shaders/edit/refit_normals.comp in double precision on the CPU.
#pragma once

#include "engine/cloud/eigen3.hpp"
#include "engine/contact/surface.hpp"

namespace palpate {

/// The weighted moments of the neighbours of a position, whose direction of least variance is its normal (Hoppe et al.
/// 1992, section 3.2).
class NormalFit {
 public:
  /// `radius`: support radius, model units.
  explicit NormalFit(double radius) : inverseRadius_(1.0 / radius) {}

  /// Over neighbours at these offsets with weights w.
  struct Sums {
    double weights = 0;
    DVec3 offsets{0};          ///< of w times the offset
    SymmetricMatrix3 squares;  ///< of the squares of the square root of w times the offset
    std::uint32_t neighbours = 0;
  };

  /// `offset`: from the position to a neighbour within the support radius, including the position itself. `share`: its
  /// weight, 0 to 1.
  void add(const DVec3& offset, double share = 1) {
    const double w = share * wendland(glm::length(offset) * inverseRadius_);
    sums_.weights += w;
    sums_.offsets += w * offset;
    sums_.squares.addSquare(std::sqrt(w) * offset);
    ++sums_.neighbours;
  }

  struct Result {
    DVec3 normal{0};      ///< unit, on the side of the old normal
    double flatness = 1;  ///< smallest over middle eigenvalue, 0 to 1: near 1 the direction is arbitrary
  };
  /// The old normal if there are too few neighbours, or they do not span a surface.
  Result normal(const DVec3& old) const { return normal(eigenSymmetric(spread(sums_)), old); }
  /// The variances of the neighbours; zero if there are too few.
  static SymmetricMatrix3 spread(const Sums& sums);
  /// Of a spread with these eigenvalues.
  static Result normal(const Eigen3& eigen, const DVec3& old);

 private:
  double inverseRadius_;
  Sums sums_;
};

}  // namespace palpate
