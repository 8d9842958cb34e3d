#include "apps/cli/matter_options.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "engine/core/error.hpp"
#include "engine/io/matter_scene_file.hpp"

namespace palpate {

namespace {

bool isBuiltIn(const std::string& name) {
  const auto names = matterSceneNames();
  return std::ranges::find(names, name) != names.end();
}

}  // namespace

MatterScene readSceneNamed(const std::string& name) {
  return isBuiltIn(name) ? matterSceneNamed(name) : readMatterScene(name);
}

std::optional<MatterScene> matterScene(const std::string& model) {
  std::error_code ignored;
  const bool names = isBuiltIn(model) && !std::filesystem::exists(model, ignored);
  if (!names && std::filesystem::path(model).extension() != ".json") return std::nullopt;
  MatterScene scene = readSceneNamed(model);
  if (scene.tool.radius_mm == 0 && scene.matter != Matter::soft) scene.tool = usualTool(scene);
  return scene;
}

std::string builtInScenes() { return fmt::format("{}", fmt::join(matterSceneNames(), ", ")); }

std::string elasticityInWords(const MatterScene& scene) {
  if (scene.preset == SoftPreset::shapeMatching)
    return fmt::format("shape matching, not calibrated: {:g} of the way back in a substep, which is no stiffness in Pa",
                       scene.stiffness);
  return fmt::format("Young's modulus {:g} Pa, Poisson's ratio {:g}, viscosity {:g} Pa s", scene.young_Pa,
                     scene.poisson, scene.viscosity_Pa_s);
}

}  // namespace palpate
