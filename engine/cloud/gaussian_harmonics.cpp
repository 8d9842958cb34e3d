#include "engine/cloud/gaussian_harmonics.hpp"

#include <cmath>
#include <numbers>

namespace palpate {

namespace {

struct Degree {
  std::size_t first, count;  // among the harmonics of degree 1 to 3
};
constexpr std::array<Degree, 3> kDegrees{{{0, 3}, {3, 5}, {8, 7}}};

}  // namespace

std::array<double, kHarmonics> harmonicsAt(const DVec3& direction) {
  const double x = direction.x, y = direction.y, z = direction.z, xx = x * x, yy = y * y, zz = z * z;
  constexpr double k1 = 0.4886025119029199, k2 = 1.0925484305920792, k20 = 0.31539156525252005,
                   k22 = 0.5462742152960396, k33 = 0.5900435899266435, k32 = 2.890611442640554,
                   k31 = 0.4570457994644658, k30 = 0.3731763325901154, k3 = 1.445305721320277;
  return {-k1 * y,
          k1 * z,
          -k1 * x,
          k2 * x * y,
          -k2 * y * z,
          k20 * (2 * zz - xx - yy),
          -k2 * x * z,
          k22 * (xx - yy),
          -k33 * y * (3 * xx - yy),
          k32 * x * y * z,
          -k31 * y * (4 * zz - xx - yy),
          k30 * z * (2 * zz - 3 * xx - 3 * yy),
          -k31 * x * (4 * zz - xx - yy),
          k3 * z * (xx - yy),
          -k33 * x * (xx - 3 * yy)};
}

// The harmonics are orthonormal: the share of one in a rotated other one is the integral of their product over the
// sphere, which these directions give exactly for products of degree 3 and 3 (four nodes of Gauss and Legendre in z,
// eight equal steps around it).
HarmonicRotation::HarmonicRotation(const DQuat& rotation) {
  constexpr std::array<std::array<double, 2>, 4> kNodes{{{-0.8611363115940526, 0.3478548451374538},
                                                         {-0.3399810435848563, 0.6521451548625461},
                                                         {0.3399810435848563, 0.6521451548625461},
                                                         {0.8611363115940526, 0.3478548451374538}}};
  constexpr int kSteps = 8;
  const DQuat back = DQuat(rotation.w, -rotation.x, -rotation.y, -rotation.z);
  for (const auto& [z, weight] : kNodes)
    for (int step = 0; step < kSteps; ++step) {
      const double around = 2 * std::numbers::pi * step / kSteps, r = std::sqrt(1 - z * z);
      const DVec3 direction(r * std::cos(around), r * std::sin(around), z);
      const auto here = harmonicsAt(direction), before = harmonicsAt(back * direction);
      const double share = weight * 2 * std::numbers::pi / kSteps;
      for (const auto& [first, count] : kDegrees)
        for (std::size_t i = 0; i < count; ++i)
          for (std::size_t k = 0; k < count; ++k) rows_[first + i][k] += share * here[first + i] * before[first + k];
    }
}

void HarmonicRotation::rotate(std::span<double> coefficients) const {
  for (const auto& [first, count] : kDegrees) {
    if (first + count > coefficients.size()) return;
    std::array<double, 7> rotated{};
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < count; ++k) rotated[i] += rows_[first + i][k] * coefficients[first + k];
    for (std::size_t i = 0; i < count; ++i) coefficients[first + i] = rotated[i];
  }
}

}  // namespace palpate
