#include "apps/cli/scene_info.hpp"

#include "engine/core/counted.hpp"
#include "engine/core/named_values.hpp"
#include "engine/matter/matter_scene.hpp"
#include "haptics/simulation/matter_choice.hpp"
#include "haptics/simulation/scene_model.hpp"
#include "haptics/simulation/scene_names.hpp"

namespace palpate {

namespace {

Json sceneJson(const MatterScene& scene, const MatterPlan& plan) {
  const auto& box = scene.box_mm;
  return {{"matter", nameOf(kMatters, scene.matter)},
          {"particles", plan.particles},
          {"substeps", plan.substeps},
          {"spacing_mm", particleSpacing_mm(scene)},
          {"box_mm", {box.x, box.y, box.z}},
          {"mass_kg", plan.mass_kg * static_cast<double>(plan.particles)},
          {"bytes", plan.bytes},
          {"gain", scene.gain}};
}

/// For a soft body. Builds its lattice, because a scan has fewer nodes than its bounding box.
void infoOfSoftBody(Context& context, const std::string& name, const MatterScene& scene) {
  const MatterPlan plan = planOf(scene);
  const Model model = sceneModel(scene, {.file = name}, {.log = context.log(), .threads = context.threads()});
  const SoftLattice& lattice = softBodyOf(model)->solid.lattice;
  const double mass_kg = scene.density_kg_m3 * lattice.volume_m3();
  const auto& box = scene.box_mm;
  std::FILE* out = context.tables();
  fmt::print(out, "{}: a soft body of {}, {:g} mm apart, with {}, in a box of {:g} x {:g} x {:g} mm\n", name,
             counted(lattice.nodes(), "node"), scene.spacing_mm, counted(model.cloud.size(), "point"), box.x, box.y,
             box.z);
  fmt::print(out, "  {}, {:.3g} kg\n", elasticityInWords(scene), mass_kg);
  fmt::print(out,
             "  {} substeps in a millisecond; its surface is felt, and pressed; the force is {:g} times the real one\n",
             plan.substeps, scene.gain);
  Json json = sceneJson(scene, plan);
  json["particles"] = lattice.nodes();
  json["mass_kg"] = mass_kg;
  json["points"] = model.cloud.size();
  json["young_Pa"] = scene.young_Pa;
  json["poisson"] = scene.poisson;
  json["viscosity_Pa_s"] = scene.viscosity_Pa_s;
  context.writeJson(json);
}

}  // namespace

void infoOfScene(Context& context, const std::string& name, const SceneRef& session) {
  const MatterScene& scene = matterOf(session);
  if (scene.matter == Matter::soft) return infoOfSoftBody(context, name, scene);
  const MatterPlan plan = planOf(scene);
  const auto& box = scene.box_mm;
  std::FILE* out = context.tables();
  fmt::print(out, "{}: {} particles of {}, {:.4g} mm apart, in a box of {:g} x {:g} x {:g} mm\n", name, plan.particles,
             nameOf(kMatters, scene.matter), 1e3 * plan.spacing_m, box.x, box.y, box.z);
  fmt::print(out, "  {}\n", layersInWords(scene));
  fmt::print(out, "  {} substeps in a millisecond, {:.3g} kg, about {:.0f} MiB\n", plan.substeps,
             plan.mass_kg * static_cast<double>(plan.particles), static_cast<double>(plan.bytes) / (1 << 20));
  fmt::print(out, "  a hand holds a ball of {:g} mm radius and {:.3g} kg; the force is {:g} times the real one\n",
             scene.tool.radius_mm, scene.tool.mass_kg, scene.gain);
  Json json = sceneJson(scene, plan);
  json["layers"] = {plan.lattice.x, plan.lattice.y, plan.lattice.z};
  json["tool"] = {{"radius_mm", scene.tool.radius_mm}, {"mass_kg", scene.tool.mass_kg}};
  context.writeJson(json);
}

}  // namespace palpate
