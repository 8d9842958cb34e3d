// Options shared by `mesh`, `render --mode mesh` and `bench mesh`.
#pragma once

#include "apps/cli/model.hpp"
#include "engine/mesh/marching_cubes.hpp"
#include "engine/render/frame.hpp"

namespace palpate {

struct MeshChoices {
  std::int64_t resolution = 128;
  std::string surface = "sphere", radius = "auto";
};
void addMeshOptions(Options& command, MeshChoices& choices);

/// The implicit surface of that name.
MeshSurface meshSurfaceNamed(const std::string& name);
/// Throws UsageError, or Error for a resolution that is too fine for the model.
MeshPlan planFor(const Model& model, const MeshChoices& choices);
/// The cloud on the GPU, ready to be meshed. Throws OutOfGpuMemory before the upload if the predicted memory is not
/// available.
MarchingCubes makeCubes(Context& context, const Model& model, const MeshPlan& plan);

/// Throws Error if a mesh of the model has no triangle. `file`: its name in the message.
void requireTriangles(const MarchingCubes& cubes, const Model& model, const MeshPlan& plan, const std::string& file);

/// Draws the triangles of a mesh of `model`; `cubes` must outlive it.
DrawnMesh drawnMesh(const MarchingCubes& cubes, const Model& model);

}  // namespace palpate
