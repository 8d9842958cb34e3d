#include "engine/cloud/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/cloud/eigen3.hpp"

namespace palpate {
namespace {

constexpr std::size_t kCoefficients = 6;
constexpr double kSingular = 1e-9;  // of a pivot, relative to the number of points: lengths are of the order of one

// Lower quartile of chi-squared with kNoisePoints - kCoefficients degrees of freedom, divided by that number
// (NIST/SEMATECH e-Handbook of Statistical Methods, section 1.3.6.7.4): a quarter of the variances is below this share
// of their mean.
constexpr double kLowerQuartile = 6.737 / 10;
static_assert(kNoisePoints - kCoefficients == 10);

}  // namespace

std::optional<double> varianceOffQuadric(std::span<const DVec3> points) {
  if (points.size() <= kCoefficients) return std::nullopt;
  const auto count = static_cast<double>(points.size());
  DVec3 mean(0);
  for (const DVec3& p : points) mean += (p - points.front()) / count;
  mean += points.front();
  SymmetricMatrix3 covariance;
  for (const DVec3& p : points) covariance.addSquare(p - mean);
  const Eigen3 eigen = eigenSymmetric(covariance);
  const double size = std::sqrt(eigen.values[2] / count);
  if (!(size > 0) || !std::isfinite(size)) return std::nullopt;

  // The normal equations, with the heights as their last column, and the sum of the squared heights.
  std::array<std::array<double, kCoefficients + 1>, kCoefficients> rows{};
  double left = 0;
  for (const DVec3& p : points) {
    const DVec3 d = (p - mean) / size;
    const double x = glm::dot(d, eigen.vectors[2]), y = glm::dot(d, eigen.vectors[1]);
    const double z = glm::dot(d, eigen.vectors[0]);
    const std::array<double, kCoefficients + 1> terms{1, x, y, x * x, x * y, y * y, z};
    for (std::size_t i = 0; i < kCoefficients; ++i)
      for (std::size_t j = i; j <= kCoefficients; ++j) rows[i][j] += terms[i] * terms[j];
    left += z * z;
  }
  // Elimination in the upper triangle; each pivot removes its share of the squares.
  for (std::size_t i = 0; i < kCoefficients; ++i) {
    const double pivot = rows[i][i];
    if (!(pivot > kSingular * count)) return std::nullopt;
    for (std::size_t r = i + 1; r < kCoefficients; ++r)
      for (std::size_t j = r; j <= kCoefficients; ++j) rows[r][j] -= rows[i][r] / pivot * rows[i][j];
    left -= rows[i][kCoefficients] * rows[i][kCoefficients] / pivot;
  }
  return std::max(0.0, left) / (count - static_cast<double>(kCoefficients)) * size * size;
}

double noiseFrom(std::vector<double>& variances) {
  if (variances.empty()) return 0;
  const auto quartile = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 4);
  std::ranges::nth_element(variances, quartile);
  return std::sqrt(*quartile / kLowerQuartile);
}

}  // namespace palpate
