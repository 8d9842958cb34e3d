#include "engine/cloud/nearest_similarity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/matrix.hpp>
#include <numeric>

#include "engine/cloud/eigen3.hpp"
#include "engine/core/check.hpp"

namespace palpate {

namespace {

using Matrix4 = std::array<std::array<double, 4>, 4>;

/// The eigenvector of a symmetric matrix with the largest eigenvalue, by cyclic Jacobi rotations.
std::array<double, 4> largestVector(Matrix4 m) {
  Matrix4 vectors{};
  for (std::size_t k = 0; k < 4; ++k) vectors[k][k] = 1;
  for (int sweep = 0; sweep < kMaxJacobiSweeps; ++sweep)
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t q = p + 1; q < 4; ++q) {
        if (m[p][q] == 0) continue;
        const auto [t, c, s] = jacobiRotation(m[p][p], m[q][q], m[p][q]);
        for (std::size_t k = 0; k < 4; ++k) {
          const double a = m[k][p], b = m[k][q];
          m[k][p] = c * a - s * b, m[k][q] = s * a + c * b;
        }
        for (std::size_t k = 0; k < 4; ++k) {
          const double a = m[p][k], b = m[q][k];
          m[p][k] = c * a - s * b, m[q][k] = s * a + c * b;
          const double u = vectors[k][p], v = vectors[k][q];
          vectors[k][p] = c * u - s * v, vectors[k][q] = s * u + c * v;
        }
        m[p][q] = m[q][p] = 0;
      }
  std::size_t largest = 0;
  for (std::size_t k = 1; k < 4; ++k)
    if (m[k][k] > m[largest][largest]) largest = k;
  return {vectors[0][largest], vectors[1][largest], vectors[2][largest], vectors[3][largest]};
}

DVec3 meanOf(std::span<const DVec3> points) {
  return std::accumulate(points.begin(), points.end(), DVec3(0)) / static_cast<double>(points.size());
}

}  // namespace

Similarity nearestSimilarity(std::span<const DVec3> before, std::span<const DVec3> now) {
  PALPATE_CHECK_EQ(before.size(), now.size());
  const DVec3 meanBefore = meanOf(before), meanNow = meanOf(now);
  glm::dmat3 s(0);  // s[j][i]: sum of coordinate i before times coordinate j now
  double squaresBefore = 0, squaresNow = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const DVec3 a = before[k] - meanBefore, b = now[k] - meanNow;
    s += glm::outerProduct(a, b);
    squaresBefore += glm::dot(a, a), squaresNow += glm::dot(b, b);
  }
  if (!(squaresBefore > 0 && squaresNow > 0)) return {};
  const auto at = [&](int i, int j) { return s[j][i]; };
  const double xx = at(0, 0), yy = at(1, 1), zz = at(2, 2), x = at(1, 2) - at(2, 1), y = at(2, 0) - at(0, 2),
               z = at(0, 1) - at(1, 0), xy = at(0, 1) + at(1, 0), yz = at(1, 2) + at(2, 1), zx = at(2, 0) + at(0, 2);
  const auto q = largestVector(
      {{{xx + yy + zz, x, y, z}, {x, xx - yy - zz, xy, zx}, {y, xy, yy - xx - zz, yz}, {z, zx, yz, zz - xx - yy}}});
  Similarity found{.rotation = glm::normalize(DQuat(q[0], q[1], q[2], q[3])),
                   .scale = std::sqrt(squaresNow / squaresBefore)};
  double left = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const DVec3 off = now[k] - meanNow - found.scale * (found.rotation * (before[k] - meanBefore));
    left += glm::dot(off, off);
  }
  found.misfit = std::sqrt(left / squaresNow);
  return found;
}

}  // namespace palpate
