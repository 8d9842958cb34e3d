// Pictures of known shapes, judged per pixel against rays cast in double precision, for `palpate bench splat`.
#pragma once

#include <string>

#include "apps/cli/context.hpp"
#include "engine/cloud/ray_cast.hpp"
#include "engine/render/frame.hpp"

namespace palpate {

/// A surface as a camera sees it: one exact ray through the centre of every `stride`-th pixel along each side.
struct PictureTruth {
  Camera camera;
  std::uint32_t width = 0, height = 0;  ///< size of the picture, pixels
  std::uint32_t stride = 1;
  std::vector<float> depth;  ///< of each ray, row by row, eye space, model units; 0 where the ray hits nothing
  std::vector<Vec3> normal;  ///< unit, model axes

  std::uint32_t columns() const { return (width + stride - 1) / stride; }
  std::uint32_t rows() const { return (height + stride - 1) / stride; }
};

/// `cloud`: samples of the surface. The camera looks at an oblique angle and sees all of it.
PictureTruth pictureTruth(const TracedSurface& surface, const PointCloud& cloud, std::uint32_t width,
                          std::uint32_t height, std::uint32_t stride, unsigned threads);

struct PictureJudgement {
  std::size_t pixels = 0;     ///< judged pixels on the surface
  std::size_t holes = 0;      ///< inside the silhouette: no surface, or one more than three spacings behind
  double overlap = 0;         ///< of the two silhouettes, intersection over union, %
  double depthRms = 0;        ///< where the picture shows the surface that the ray meets, spacings
  double normalMean_deg = 0;  ///< angle to the true normal, on the same pixels
  double normalP95_deg = 0;
};

/// `spacing`: mean of the cloud, model units. `depth` and `normals`: read back from the frame with one sample per
/// pixel; `normals` from ImagePass::normal.
PictureJudgement judgePicture(const PictureTruth& truth, const DepthImage& depth, const Image& normals, double spacing);

}  // namespace palpate
