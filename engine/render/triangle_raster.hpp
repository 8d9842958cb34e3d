#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/render/compute_raster.hpp"
#include "engine/render/drawn_mesh.hpp"

namespace palpate {

/// Draws the triangles of a mesh in compute shaders: first the nearest depth, then the attributes there.
class TriangleRaster {
 public:
  explicit TriangleRaster(Device& device);

  /// `tiles`: along each side of the largest triangle (tilesOf()).
  void record(CommandList& list, const DrawnMesh& mesh, std::uint32_t tiles, const RasterTarget& target) const;

 private:
  ComputePipeline depth_, attributes_;
};

}  // namespace palpate
