// Pictures of known shapes, judged per pixel against rays cast in double precision, for `palpate bench splat`.
#pragma once

#include <functional>

#include "apps/bench/bench.hpp"
#include "apps/cli/context.hpp"
#include "apps/cli/mesh_options.hpp"
#include "engine/cloud/ray_cast.hpp"
#include "engine/render/frame.hpp"

namespace palpate {

/// The methods of drawing a cloud that `palpate bench splat` compares: its discs by either rasteriser, or marching
/// cubes.
struct PictureWay {
  std::string name;                   ///< compute, hardware, or "mesh" and its resolution
  Summary made_ms;                    ///< GPU time of preparation before the first picture; no samples for discs
  std::uint64_t bytes = 0;            ///< GPU memory of the drawn data
  const DrawnCloud* discs = nullptr;  ///< null for a mesh
  std::function<void(Frame&, CommandList&, const Camera&, const FrameOptions&)> record;
};

struct WayOptions : BenchOptions {
  std::vector<std::string> rasters{"compute"};  ///< FrameOptions::raster
  std::vector<std::int64_t> meshes;             ///< resolutions
};

/// Prepares the data of each method, calls `visit` and frees it, one method after the other.
void forEachWay(Context& context, const Model& model, const WayOptions& options,
                const std::function<void(const PictureWay&)>& visit);

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
