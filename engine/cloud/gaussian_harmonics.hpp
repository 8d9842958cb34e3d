// Rotation of the colours by direction of view that Gaussians have: real spherical harmonics of degree 1 to 3, with the
// signs and order of 3DGS (Kerbl et al. 2023).
#pragma once

#include <array>
#include <span>

#include "engine/core/vec.hpp"

namespace palpate {

/// Number of harmonics of degree 1 to 3.
inline constexpr std::size_t kHarmonics = 15;

/// The values of these harmonics in the direction of a unit vector.
std::array<double, kHarmonics> harmonicsAt(const DVec3& direction);

class HarmonicRotation {
 public:
  /// `rotation`: unit.
  explicit HarmonicRotation(const DQuat& rotation);

  /// Replaces the coefficients of one colour channel, without that of degree 0, by those of the rotated colour: what it
  /// was in a direction d it is now in rotation * d. Coefficients that do not complete a degree, and those of degree 4
  /// and more, stay as they are.
  void rotate(std::span<double> coefficients) const;

 private:
  std::array<std::array<double, 7>, kHarmonics> rows_{};  ///< of each result: the shares of those of its degree
};

}  // namespace palpate
