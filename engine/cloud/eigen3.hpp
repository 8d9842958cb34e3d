// Eigenvalues and eigenvectors of symmetric 3 x 3 matrices by cyclic Jacobi rotations (Golub and Van Loan 2013,
// section 8.5), in double precision: a little slower than the closed form and accurate for every input, also with equal
// or vanishing eigenvalues.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "engine/core/vec.hpp"

namespace palpate {

struct SymmetricMatrix3 {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  /// Adds the outer product of `v` with itself.
  void addSquare(const DVec3& v) {
    xx += v.x * v.x, yy += v.y * v.y, zz += v.z * v.z;
    xy += v.x * v.y, xz += v.x * v.z, yz += v.y * v.z;
  }
};

struct Eigen3 {
  std::array<double, 3> values;  ///< ascending
  std::array<DVec3, 3> vectors;  ///< of these values in order; unit length, pairwise perpendicular, of either sign
};

/// The plane rotation that makes an entry beside the diagonal zero.
struct JacobiRotation {
  double t, c, s;  ///< tangent, cosine and sine of its angle
};
/// `app`, `aqq`: the entries on the diagonal; `apq`: the other one, not zero.
inline JacobiRotation jacobiRotation(double app, double aqq, double apq) {
  const double theta = (aqq - app) / (2 * apq);
  // Rounded alike on every system, unlike std::hypot. A theta whose square overflows rotates by nothing.
  const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
  const double c = 1 / std::sqrt(t * t + 1);
  return {t, c, t * c};
}
inline constexpr int kMaxJacobiSweeps = 32;       ///< six are enough in practice; convergence is quadratic
inline constexpr double kMinOffDiagonal = 1e-40;  ///< sum of squares beside the diagonal; the largest entry is 1 to 2

/// Exponent of the power of two that scales the largest entry of a matrix to 1 to 2, so that scaling is exact and
/// squares neither overflow nor vanish.
inline int exponentOf(const SymmetricMatrix3& m) {
  double largest = 0;
  for (const double entry : {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz}) largest = std::max(largest, std::fabs(entry));
  return largest > 0 ? std::ilogb(largest) : 0;
}

/// std::scalbn(), without a call where the power of two is a normal number: the product is then rounded alike.
inline double timesPowerOfTwo(double x, int exponent) {
  constexpr int kBias = 1023, kMantissaBits = 52;
  if (std::abs(exponent) >= kBias) return std::scalbn(x, exponent);
  return x * std::bit_cast<double>(static_cast<std::uint64_t>(exponent + kBias) << kMantissaBits);
}

/// Ascending order and unit length. `diagonal`: after all rotations; `columns`: the vectors.
inline Eigen3 sortedEigen(const std::array<double, 3>& diagonal, const std::array<DVec3, 3>& columns, int exponent) {
  std::array<int, 3> order{0, 1, 2};
  const auto sortPair = [&](int i, int j) {
    if (diagonal[order[i]] > diagonal[order[j]]) std::swap(order[i], order[j]);
  };
  sortPair(0, 1), sortPair(1, 2), sortPair(0, 1);
  Eigen3 result;
  for (int k = 0; k < 3; ++k) {
    result.values[k] = timesPowerOfTwo(diagonal[order[k]], exponent);
    result.vectors[k] = glm::normalize(columns[order[k]]);
  }
  return result;
}

/// Defined for every matrix of finite entries; the zero matrix gives the axes.
inline Eigen3 eigenSymmetric(const SymmetricMatrix3& matrix) {
  double a[3][3] = {
      {matrix.xx, matrix.xy, matrix.xz}, {matrix.xy, matrix.yy, matrix.yz}, {matrix.xz, matrix.yz, matrix.zz}};
  const int exponent = exponentOf(matrix);
  for (auto& row : a)
    for (double& entry : row) entry = timesPowerOfTwo(entry, -exponent);

  std::array<DVec3, 3> columns{DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1)};
  for (int sweep = 0; sweep < kMaxJacobiSweeps; ++sweep) {
    const double offDiagonal = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
    if (offDiagonal < kMinOffDiagonal) break;
    for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
      if (a[p][q] == 0) continue;
      const auto [t, c, s] = jacobiRotation(a[p][p], a[q][q], a[p][q]);
      const int r = 3 - p - q;
      const double arp = a[r][p], arq = a[r][q];
      a[p][p] -= t * a[p][q];
      a[q][q] += t * a[p][q];
      a[p][q] = a[q][p] = 0;
      a[r][p] = a[p][r] = c * arp - s * arq;
      a[r][q] = a[q][r] = s * arp + c * arq;
      const DVec3 vp = columns[p], vq = columns[q];
      columns[p] = c * vp - s * vq;
      columns[q] = s * vp + c * vq;
    }
  }
  return sortedEigen({a[0][0], a[1][1], a[2][2]}, columns, exponent);
}

}  // namespace palpate
