#pragma once

#include <array>
#include <cstddef>

namespace palpate {

/// Weighted least squares with six unknowns in double precision: sums over rows J with residual r, minimising |J x +
/// r|.
struct NormalEquations {
  static constexpr std::size_t kUnknowns = 6;
  using Row = std::array<double, kUnknowns>;
  std::array<Row, kUnknowns> matrix{};  ///< sum of w J J^T, both halves
  Row side{};                           ///< sum of w J r
  double weights = 0;                   ///< sum of w
  double squares = 0;                   ///< sum of w r^2

  void add(const Row& row, double residual, double weight);
  NormalEquations& operator+=(const NormalEquations& other);
};

/// Eigenvalues, ascending, and unit eigenvectors of a symmetric matrix, by cyclic Jacobi rotations (Golub and Van Loan
/// 2013, section 8.5).
struct Eigen6 {
  NormalEquations::Row values{};
  std::array<NormalEquations::Row, NormalEquations::kUnknowns> vectors{};
};
Eigen6 eigenSymmetric(std::array<NormalEquations::Row, NormalEquations::kUnknowns> matrix);

/// Least-squares x without components along eigenvectors whose eigenvalues are not above `least`.
NormalEquations::Row solve(const NormalEquations& equations, double least = 0);

}  // namespace palpate
