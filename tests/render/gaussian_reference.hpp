// Gaussians of a picture in double precision, independent of the shaders: each pixel visits all of them.
#pragma once

#include <vector>

#include "engine/cloud/gaussian_records.hpp"
#include "engine/render/camera.hpp"
#include "engine/render/image.hpp"

namespace palpate {

/// A Gaussian as a file has it.
struct FileGaussian {
  DVec3 center{0};
  DVec3 logScales{-3};
  DVec4 rotation{1, 0, 0, 0};  ///< w x y z, of any length
  double opacityLogit = 2;
  DVec3 color{0};                ///< harmonic of degree 0
  std::vector<DVec3> harmonics;  ///< of degree 1 and more
};

/// Gaussians in the columns of 3DGS, as floats; all have as many harmonics as the first one.
std::shared_ptr<const GaussianRecords> recordsOf(const std::vector<FileGaussian>& gaussians);

/// A pixel of the composited picture.
struct CompositedPixel {
  DVec3 color{0};  ///< as encoded for a screen, times opacity
  double transmittance = 1;
  double depth = 0;  ///< at which half of the light is blocked; 0: nowhere
};
/// Row by row from the top.
std::vector<CompositedPixel> composited(const std::vector<FileGaussian>& gaussians, const Camera& camera,
                                        const UVec2& size_px);

}  // namespace palpate
