#include "haptics/session/matter_scenes.hpp"

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

bool isFile(const std::string& name) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(name, ignored);
}

// A file in place of what stands in a scene that is built in, or is soft there; nothing where the name is no such thing.
std::optional<MatterScene> sceneOfFile(const std::string& name) {
  const auto around = [](MatterScene scene, const std::string& file) {
    scene.model = file;
    return scene;
  };
  const std::string_view inWater = " in water", inSand = " in sand", soft = "soft ";
  if (name.ends_with(inWater) || name.ends_with(inSand)) {
    const bool water = name.ends_with(inWater);
    const std::string file = name.substr(0, name.size() - (water ? inWater : inSand).size());
    if (!isFile(file)) return std::nullopt;
    MatterScene scene = around(matterSceneNamed("statue in water"), file);
    if (!water) scene.matter = Matter::sand;
    return scene;
  }
  if (!name.starts_with(soft) || !isFile(name.substr(soft.size()))) return std::nullopt;
  MatterScene scene = around(matterSceneNamed("soft statue"), name.substr(soft.size()));
  scene.shape = MatterScene{}.shape;  // the file has it
  return scene;
}

}  // namespace

MatterScene readSceneNamed(const std::string& name) {
  if (isFile(name)) return readMatterScene(name);
  if (const auto scene = sceneOfFile(name)) return *scene;
  return isBuiltIn(name) ? matterSceneNamed(name) : readMatterScene(name);
}

std::optional<MatterScene> matterScene(const std::string& model) {
  const bool names = !isFile(model) && (isBuiltIn(model) || sceneOfFile(model));
  if (!names && std::filesystem::path(model).extension() != ".json") return std::nullopt;
  MatterScene scene = readSceneNamed(model);
  if (scene.tool.radius_mm == 0 && scene.matter != Matter::soft) scene.tool = usualTool(scene);
  return scene;
}

std::string builtInScenes() {
  return fmt::format("{}, FILE in water, FILE in sand, soft FILE", fmt::join(matterSceneNames(), ", "));
}

std::string elasticityInWords(const MatterScene& scene) {
  if (scene.preset == SoftPreset::shapeMatching)
    return fmt::format("shape matching, not calibrated: {:g} of the way back in a substep, which is no stiffness in Pa",
                       scene.stiffness);
  return fmt::format("Young's modulus {:g} Pa, Poisson's ratio {:g}, viscosity {:g} Pa s", scene.young_Pa,
                     scene.poisson, scene.viscosity_Pa_s);
}

}  // namespace palpate
