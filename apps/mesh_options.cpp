#include "apps/mesh_options.hpp"

#include <algorithm>

namespace palpate {

namespace {

std::vector<std::string> surfaceNames() {
  std::vector<std::string> names;
  for (const auto& [name, unused] : kMeshSurfaces) names.emplace_back(name);
  return names;
}

}  // namespace

void addMeshOptions(CLI::App& command, MeshChoices& choices) {
  command.add_option("--lattice", choices.lattice, "cells along the longest side of the model")
      ->check(wholeBetween(1, kFinestLattice))
      ->capture_default_str();
  command
      .add_option(
          "--surface", choices.surface,
          "what is meshed: sphere, average, sharp: as touch feels them; density: a skin where the density of the "
          "points falls to half (thesis 3.2)")
      ->check(CLI::IsMember(surfaceNames()))
      ->capture_default_str();
  command
      .add_option("--radius", choices.radius,
                  "support radius, mm, or auto: four spacings; at least 2.5 cells in any case")
      ->check(lengthOrAuto())
      ->capture_default_str();
}

MeshSurface meshSurfaceNamed(const std::string& name) {
  const auto* found = std::ranges::find(kMeshSurfaces, name, [](const auto& pair) { return pair.first; });
  PALPATE_CHECK(found != kMeshSurfaces.end());
  return found->second;
}

MeshPlan planFor(const Model& model, const MeshChoices& choices) {
  return planMesh(boundsOf(model.cloud), model.spacing,
                  {.lattice = static_cast<std::uint32_t>(choices.lattice),
                   .surface = meshSurfaceNamed(choices.surface),
                   .radius = choices.radius == "auto" ? 0 : supportRadius(choices.radius, model)});
}

MarchingCubes makeCubes(Context& context, const Model& model, const MeshPlan& plan) {
  requireMeshMemory(context.device(), predictMeshMemory(model.cloud, plan));
  return {context.device(), model.cloud, plan};
}

}  // namespace palpate
