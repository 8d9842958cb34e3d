#include "apps/cli/mesh_options.hpp"

#include <algorithm>

#include "engine/core/counted.hpp"
#include "engine/core/named_values.hpp"
#include "engine/mesh/mesh_memory.hpp"

namespace palpate {

void addMeshOptions(Options& command, MeshChoices& choices) {
  command.add("--resolution", choices.resolution, "cells along the longest side of the model")
      .check(wholeBetween(1, kMaxResolution))
      .showDefault();
  command
      .add("--surface", choices.surface,
           "surface to mesh: sphere, average or sharp (as they are felt), or density (where the density "
           "of the points falls to half)")
      .check(oneOf(namesOf(kMeshSurfaces)))
      .showDefault();
  command.add("--radius", choices.radius, "support radius, mm, or auto (four spacings); at least 2.5 cells in any case")
      .check(lengthOrAuto())
      .showDefault();
}

MeshSurface meshSurfaceNamed(const std::string& name) {
  const auto found = valueNamed(kMeshSurfaces, name);
  PALPATE_CHECK(found.has_value());
  return *found;
}

MeshPlan planFor(const Model& model, const MeshChoices& choices) {
  const MeshPlan plan = planMesh(model.shownBounds(), model.spacing,
                                 {.resolution = static_cast<std::uint32_t>(choices.resolution),
                                  .surface = meshSurfaceNamed(choices.surface),
                                  .radius = choices.radius == "auto" ? 0 : supportRadius(choices.radius, model)});
  return thinned(plan, model.cloud);
}

MarchingCubes makeCubes(Context& context, const Model& model, const MeshPlan& plan) {
  requireMeshMemory(context.device(), predictMeshMemory(model.cloud, plan));
  return {context.device(), model.cloud, plan};
}

void requireTriangles(const MarchingCubes& cubes, const Model& model, const MeshPlan& plan, const std::string& file) {
  constexpr std::size_t kNoSurface = 2;  // points
  if (cubes.triangleCount() > 0) return;
  const std::string points = counted(model.cloud.size(), "point");
  if (model.cloud.size() <= kNoSurface) throw Error("{}: {}: too few for a surface, so there is no mesh", file, points);
  throw Error("{}: no surface within {:.3g} mm (in the hand) of its {}; try a larger --radius", file,
              model.scale.toMm(static_cast<double>(plan.lattice.radius)), points);
}

DrawnMesh drawnMesh(const MarchingCubes& cubes, const Model& model) {
  return {.vertices = cubes.vertices().address(),
          .triangles = cubes.triangles().address(),
          .triangleCount = cubes.triangleCount(),
          .hasColors = cubes.hasColors(),
          .bounds = boundsOf(model.cloud),
          .cell = static_cast<double>(cubes.plan().lattice.cell)};
}

}  // namespace palpate
