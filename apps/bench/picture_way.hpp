// The methods of drawing a cloud that `palpate bench splat` compares: its discs by either rasteriser, or marching
// cubes.
#pragma once

#include <functional>

#include "apps/bench/bench.hpp"
#include "apps/cli/mesh_options.hpp"
#include "engine/render/frame.hpp"

namespace palpate {

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

}  // namespace palpate
