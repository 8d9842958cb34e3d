// A scene of 3D Gaussians (Kerbl, Kopanas, Leimkuehler and Drettakis 2023, "3D Gaussian splatting for real-time
// radiance field rendering"), as trained. The meaning of a file's numbers is defined only here.
#pragma once

#include <cstddef>

#include "engine/core/bare_vector.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// The spherical harmonic of degree 0: 1 / (2 sqrt(pi)).
inline constexpr double kZeroHarmonic = 0.28209479177387814;

/// One entry per Gaussian in each array; all finite.
struct GaussianScene {
  BareVector<DVec3> centers;        ///< model units
  BareVector<Vec3> logScales;       ///< natural logarithms of the standard deviations along its axes, model units
  BareVector<Vec4> rotations;       ///< w x y z, of any length; rotates the axes into the scene. Zero is the identity
  BareVector<float> opacityLogits;  ///< opacity = 1 / (1 + e^-o)
  BareVector<Vec3> colorHarmonics;  ///< degree 0: colour = 0.5 + kZeroHarmonic f, from 0 to 1

  std::size_t size() const { return centers.size(); }
};

}  // namespace palpate
