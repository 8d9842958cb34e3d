#include "haptics/simulation/scene_names.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/foreign_file.hpp"
#include "engine/matter/matter_scene_file.hpp"
#include "haptics/session/simulation.hpp"
#include "haptics/simulation/matter_choice.hpp"

namespace palpate {

namespace {

bool isFile(const std::string& name) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(name, ignored);
}

// The alphabetically first cloud file whose path begins with `beginning`; empty: there is none.
std::string fileThatBegins(const std::string& beginning) {
  const std::filesystem::path path(beginning);
  const std::string endings = cloudFormats().endingsRead();
  std::string first;
  std::error_code ignored;
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string(), ending = entry.path().extension().string();
    if (!name.starts_with(path.filename().string()) || ending.empty() || endings.find(ending) == std::string::npos)
      continue;
    const std::string found = path.has_parent_path() ? entry.path().string() : name;
    if (first.empty() || found < first) first = found;
  }
  return first;
}

// Throws an error that suggests a name in place of "bunny in water" or "soft scan", since there is no file of that
// name.
[[noreturn]] void refuseFile(const std::string& name, const std::string& file) {
  const std::string found = fileThatBegins(file);
  std::string as = name;
  as.replace(as.find(file), file.size(), found.empty() ? "bunny.ply" : found);
  throw FileError(
      name, fmt::format("there is no file '{}'; type the name of a closed cloud's file with its ending{} \"{}\"", file,
                        found.empty() ? ", as in" : ", here", as));
}

// A built-in scene with a file as its standing or soft body; empty if the name does not denote one.
std::optional<MatterScene> sceneOfFile(const std::string& name) {
  const auto around = [](MatterScene scene, const std::string& file) {
    scene.model = file;
    return scene;
  };
  const std::string_view inWater = " in water", inSand = " in sand", soft = "soft ";
  if (name.ends_with(inWater) || name.ends_with(inSand)) {
    const bool water = name.ends_with(inWater);
    const std::string file = name.substr(0, name.size() - (water ? inWater : inSand).size());
    if (!isFile(file)) refuseFile(name, file);
    MatterScene scene = around(matterSceneNamed("statue in water"), file);
    if (!water) scene.matter = Matter::sand;
    return scene;
  }
  if (!name.starts_with(soft)) return std::nullopt;
  const std::string file = name.substr(soft.size());
  if (!isFile(file)) refuseFile(name, file);
  MatterScene scene = around(matterSceneNamed("soft statue"), file);
  scene.shape = MatterScene{}.shape;  // the file has the shape
  return scene;
}

}  // namespace

MatterScene readSceneNamed(const std::string& name) {
  if (isFile(name)) return readMatterScene(name);
  if (isBuiltInScene(name)) return matterSceneNamed(name);
  if (const auto scene = sceneOfFile(name)) return *scene;
  std::error_code ignored;
  if (!std::filesystem::exists(name, ignored) && std::filesystem::path(name).extension() != ".json")
    throw FileError(name, fmt::format("is neither a scene nor a file; scenes: a JSON file, {}", builtInScenes()));
  return readMatterScene(name);
}

std::optional<MatterScene> matterScene(const std::string& model) {
  std::error_code ignored;
  const bool isThere = std::filesystem::exists(model, ignored);  // a folder may be a recording
  const bool names = (!isFile(model) && isBuiltInScene(model)) || (!isThere && sceneOfFile(model));
  if (!names && std::filesystem::path(model).extension() != ".json") return std::nullopt;
  refuseForeign(model);
  MatterScene scene = readSceneNamed(model);
  if (scene.tool.radius_mm == 0 && scene.matter != Matter::soft) scene.tool = usualTool(scene);
  return scene;
}

bool canSimulate() { return true; }

SceneRef sceneNamed(const std::string& model) {
  const std::optional<MatterScene> scene = matterScene(model);
  return scene ? sceneRef(*scene) : SceneRef();
}

bool isBuiltInScene(std::string_view name) {
  const auto names = matterSceneNames();
  return std::ranges::find(names, name) != names.end();
}

std::vector<std::string> builtInSceneNames() {
  const auto names = matterSceneNames();
  return {names.begin(), names.end()};
}

std::string builtInScenes() {
  return fmt::format(
      "{}, or, with the file of a closed cloud and in quotes, \"bunny.ply in water\", \"bunny.ply in sand\" or "
      "\"soft bunny.ply\"",
      fmt::join(matterSceneNames(), ", "));
}

std::string layersInWords(const MatterScene& scene) {
  constexpr double kMm3InLitre = 1e6;
  const UVec3 layers = planOf(scene).lattice;
  const DVec3& fill = scene.fill_mm;
  const double spacing_mm = particleSpacing_mm(scene);
  std::string words = fmt::format("{} x {} x {} layers fill {:g} x {:g} x {:g} mm, {:.4g} litres", layers.x, layers.y,
                                  layers.z, fill.x, fill.y, fill.z, fill.x * fill.y * fill.z / kMm3InLitre);
  if (spacing_mm < scene.spacing_mm)
    words += fmt::format("; {:.4g} mm apart in place of {:g}, to fill it exactly", spacing_mm, scene.spacing_mm);
  return words;
}

std::string elasticityInWords(const MatterScene& scene) {
  return fmt::format("Young's modulus {:g} Pa, Poisson's ratio {:g}, viscosity {:g} Pa s", scene.young_Pa,
                     scene.poisson, scene.viscosity_Pa_s);
}

}  // namespace palpate
