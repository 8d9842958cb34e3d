#include "engine/render/triangle_raster.hpp"

#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

// Small workgroups: a workgroup lasts as long as its largest triangle, and the touch side may be waiting for its place
// on the GPU.
constexpr std::uint32_t kTriangleWorkgroup = 64;

}  // namespace

TriangleRaster::TriangleRaster(Device& device)
    : depth_(device, shader_code::render_triangle_depth,
             {.workgroupSize = kTriangleWorkgroup, .pushBytes = sizeof(shared::TriangleArgs)}),
      attributes_(device, shader_code::render_triangle_attributes,
                  {.workgroupSize = kTriangleWorkgroup, .pushBytes = sizeof(shared::TriangleArgs)}) {}

void TriangleRaster::record(CommandList& list, const DrawnMesh& mesh, std::uint32_t tiles,
                            const RasterTarget& target) const {
  const std::uint64_t shares = std::uint64_t{mesh.triangleCount} * tiles * tiles;
  const shared::TriangleArgs args{.vertices = mesh.vertices,
                                  .triangles = mesh.triangles,
                                  .depth = target.depth,
                                  .normalSums = target.normalSums,
                                  .colorSums = target.colorSums};
  list.dispatch(depth_, shares, args);
  list.dispatch(attributes_, shares, args);
}

}  // namespace palpate
