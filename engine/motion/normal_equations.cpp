#include "engine/motion/normal_equations.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate {

namespace {

constexpr std::size_t kN = NormalEquations::kUnknowns;
using Row = NormalEquations::Row;
using Matrix = std::array<Row, kN>;

// Rotates axes p and q so that the entry between them becomes 0.
void rotate(Matrix& a, Matrix& columns, std::size_t p, std::size_t q) {
  if (a[p][q] == 0) return;
  const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::hypot(theta, 1.0));
  const double c = 1 / std::hypot(t, 1.0);
  const double s = t * c;
  for (std::size_t k = 0; k < kN; ++k) {
    const double kp = a[k][p], kq = a[k][q];
    a[k][p] = c * kp - s * kq;
    a[k][q] = s * kp + c * kq;
  }
  for (std::size_t k = 0; k < kN; ++k) {
    const double pk = a[p][k], qk = a[q][k];
    a[p][k] = c * pk - s * qk;
    a[q][k] = s * pk + c * qk;
    const double vp = columns[p][k], vq = columns[q][k];
    columns[p][k] = c * vp - s * vq;
    columns[q][k] = s * vp + c * vq;
  }
  a[p][q] = a[q][p] = 0;
}

}  // namespace

void NormalEquations::add(const Row& row, double residual, double weight) {
  for (std::size_t i = 0; i < kN; ++i) {
    for (std::size_t j = 0; j < kN; ++j) matrix[i][j] += weight * row[i] * row[j];
    side[i] += weight * row[i] * residual;
  }
  weights += weight;
  squares += weight * residual * residual;
}

NormalEquations& NormalEquations::operator+=(const NormalEquations& other) {
  for (std::size_t i = 0; i < kN; ++i) {
    for (std::size_t j = 0; j < kN; ++j) matrix[i][j] += other.matrix[i][j];
    side[i] += other.side[i];
  }
  weights += other.weights;
  squares += other.squares;
  return *this;
}

Eigen6 eigenSymmetric(Matrix a) {
  Matrix columns{};
  double trace = 0;
  for (std::size_t k = 0; k < kN; ++k) {
    columns[k][k] = 1;
    trace += std::fabs(a[k][k]);
  }
  constexpr int kMaxSweeps = 32;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double offDiagonal = 0;
    for (std::size_t p = 0; p < kN; ++p)
      for (std::size_t q = p + 1; q < kN; ++q) offDiagonal += std::fabs(a[p][q]);
    if (!(offDiagonal > 1e-18 * trace)) break;
    for (std::size_t p = 0; p < kN; ++p)
      for (std::size_t q = p + 1; q < kN; ++q) rotate(a, columns, p, q);
  }
  std::array<std::size_t, kN> order;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return a[k][k]; });
  Eigen6 eigen;
  for (std::size_t k = 0; k < kN; ++k) {
    eigen.values[k] = a[order[k]][order[k]];
    eigen.vectors[k] = columns[order[k]];
  }
  return eigen;
}

Row solve(const NormalEquations& equations, double least) {
  const Eigen6 eigen = eigenSymmetric(equations.matrix);
  Row x{};
  for (std::size_t k = 0; k < kN; ++k) {
    if (!(eigen.values[k] > least)) continue;
    const Row& v = eigen.vectors[k];
    const double along = std::inner_product(v.begin(), v.end(), equations.side.begin(), 0.0);
    for (std::size_t i = 0; i < kN; ++i) x[i] -= along / eigen.values[k] * v[i];
  }
  return x;
}

}  // namespace palpate
