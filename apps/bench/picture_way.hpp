// The ways to draw a cloud that `palpate bench splat` compares: its discs by one of the rasterisers, or marching cubes.
#pragma once

#include <functional>

#include "apps/bench/bench.hpp"
#include "apps/cli/mesh_options.hpp"
#include "engine/render/frame.hpp"

namespace palpate {

/// The triangles of a mesh of `model`, which must outlive what is drawn.
DrawnMesh drawnMesh(const MarchingCubes& cubes, const Model& model);

struct PictureWay {
  std::string name;         ///< compute, hardware, or "mesh" and its lattice
  Summary made_ms;          ///< what has to be made before the first picture, on the GPU; no samples for discs
  std::uint64_t bytes = 0;  ///< of what is drawn
  const DrawnCloud* discs = nullptr;  ///< none of a mesh
  std::function<void(Frame&, CommandList&, const Camera&, const FrameOptions&)> record;
};

struct WayOptions : BenchOptions {
  std::vector<std::string> rasters{"compute"};  ///< FrameOptions::raster
  std::vector<std::int64_t> meshes;             ///< lattices
};

/// Makes what each way of the options draws, calls `visit`, and gives it back, one after the other.
void forEachWay(Context& context, const Model& model, const WayOptions& options,
                const std::function<void(const PictureWay&)>& visit);

}  // namespace palpate
