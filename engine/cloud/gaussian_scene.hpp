// A scene of 3D Gaussians (Kerbl, Kopanas, Leimkuehler and Drettakis 2023, "3D Gaussian splatting for real-time
// radiance field rendering"), as trained: what the numbers of a file stand for is said here, and nowhere else is it
// known.
#pragma once

#include <cstddef>

#include "engine/core/bare_vector.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// One entry of each for every Gaussian; all finite.
struct GaussianScene {
  BareVector<DVec3> centers;        ///< model units
  BareVector<Vec3> logScales;       ///< natural logarithms of the deviations along its axes, model units
  BareVector<Vec4> rotations;       ///< w x y z, of any length; turns the axes into the scene. Zero turns nothing
  BareVector<float> opacityLogits;  ///< opacity = 1 / (1 + e^-o)
  BareVector<Vec3> colorHarmonics;  ///< degree 0: colour = 0.5 + 0.28209479 f, from 0 to 1

  std::size_t size() const { return centers.size(); }
};

}  // namespace palpate
