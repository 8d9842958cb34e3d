// The computation of shaders/edit/refit_normals.comp in double precision on the CPU.
#pragma once

#include <array>

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
    SymmetricMatrix3 squares;  ///< of w times the products of the offset's coordinates
    std::uint32_t neighbours = 0;
  };

  /// Each sum is that of kLanes sums, of every kLanes-th neighbour each, so that processors add that many at a time.
  static constexpr std::size_t kLanes = 8;
  using Lanes = std::array<double, kLanes>;
  static double sumOf(Lanes lanes) {
    for (std::size_t half = kLanes / 2; half > 0; half /= 2)
      for (std::size_t lane = 0; lane < half; ++lane) lanes[lane] += lanes[lane + half];
    return lanes.front();
  }

  /// `offset`: from the position to a neighbour within the support radius, including the position itself. `share`: its
  /// weight, 0 to 1; a neighbour without one counts only in the order of the lanes.
  void add(const DVec3& offset, double share = 1) {
    const double w = share * wendland(glm::length(offset) * inverseRadius_);
    const DVec3 wo = w * offset;
    const std::array terms{w,
                           wo.x,
                           wo.y,
                           wo.z,
                           wo.x * offset.x,
                           wo.y * offset.y,
                           wo.z * offset.z,
                           wo.x * offset.y,
                           wo.x * offset.z,
                           wo.y * offset.z};
    for (std::size_t term = 0; term < terms.size(); ++term) lanes_[term][added_ % kLanes] += terms[term];
    ++added_;
    neighbours_ += share > 0;
  }

  struct Result {
    DVec3 normal{0};      ///< unit, on the side of the old normal
    double flatness = 1;  ///< smallest over middle eigenvalue, 0 to 1: near 1 the direction is arbitrary
  };
  /// The old normal if there are too few neighbours, or they do not span a surface.
  Result normal(const DVec3& old) const { return normal(eigenSymmetric(spread(sums())), old); }
  /// The variances of the neighbours; zero if there are too few.
  static SymmetricMatrix3 spread(const Sums& sums);
  /// Of a spread with these eigenvalues.
  static Result normal(const Eigen3& eigen, const DVec3& old);

 private:
  Sums sums() const;

  double inverseRadius_;
  std::array<Lanes, 10> lanes_{};  // of the sums
  std::size_t added_ = 0;
  std::uint32_t neighbours_ = 0;
};

}  // namespace palpate
