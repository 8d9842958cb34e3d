// Eigenvalues and eigenvectors of symmetric 3 x 3 matrices by cyclic Jacobi rotations (Golub and Van Loan 2013,
// section 8.5), in double precision: a little slower than the closed form and accurate for every input, also with equal
// or vanishing eigenvalues.
#pragma once

#include <array>
#include <cmath>
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

/// Defined for every matrix of finite entries; the zero matrix gives the axes.
inline Eigen3 eigenSymmetric(const SymmetricMatrix3& matrix) {
  double a[3][3] = {
      {matrix.xx, matrix.xy, matrix.xz}, {matrix.xy, matrix.yy, matrix.yz}, {matrix.xz, matrix.yz, matrix.zz}};
  double largest = 0;
  for (const auto& row : a)
    for (const double entry : row) largest = std::fmax(largest, std::fabs(entry));
  // A power of two, so that scaling is exact and squares neither overflow nor vanish.
  const int exponent = largest > 0 ? std::ilogb(largest) : 0;
  for (auto& row : a)
    for (double& entry : row) entry = std::scalbn(entry, -exponent);

  std::array<DVec3, 3> columns{DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1)};
  constexpr int kMaxSweeps = 32;  // six are enough in practice; convergence is quadratic
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    const double offDiagonal = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
    if (offDiagonal < 1e-40) break;
    for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
      if (a[p][q] == 0) continue;
      const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
      // Rounded alike on every system, unlike std::hypot. A theta whose square overflows rotates by nothing.
      const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
      const double c = 1 / std::sqrt(t * t + 1);
      const double s = t * c;
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

  std::array<int, 3> order{0, 1, 2};
  const auto sortPair = [&](int i, int j) {
    if (a[order[i]][order[i]] > a[order[j]][order[j]]) std::swap(order[i], order[j]);
  };
  sortPair(0, 1), sortPair(1, 2), sortPair(0, 1);
  Eigen3 result;
  for (int k = 0; k < 3; ++k) {
    result.values[k] = std::scalbn(a[order[k]][order[k]], exponent);
    result.vectors[k] = glm::normalize(columns[order[k]]);
  }
  return result;
}

}  // namespace palpate
