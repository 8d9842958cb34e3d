#include "engine/matter/matter_scene_file.hpp"

#include <nlohmann/json.hpp>

#include "engine/io/chunked_file.hpp"
#include "engine/matter/matter_model.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxSceneFile = std::size_t{1} << 20;  // bytes

// A scene has the settings of its kind of matter.
void requireBelonging(const SettingsJson& json, const MatterScene& scene) {
  for (const SceneSetting& each : sceneSettings()) {
    const std::string_view name = each.setting.name;
    if (json.contains(std::string(name)) && !each.isOf(scene.matter))
      throw ConfigError(name, "does not apply to {}", nameOf(kMatters, scene.matter));
  }
  if (json.contains("preset") && scene.matter != Matter::soft)
    throw ConfigError("preset", "does not apply to {}", nameOf(kMatters, scene.matter));
}

}  // namespace

MatterScene readScene(std::string_view path, const SettingsJson& json) {
  // Every scene in a log of an earlier version names the preset of soft bodies, and the stiffness of another preset.
  std::vector<std::string_view> former;
  if (json.is_object() && json.contains("preset")) {
    if (json["preset"] != "elastic")
      throw ConfigError(pathOf(path, "preset"), "is {}; only elastic is left: use young_Pa, poisson and viscosity_Pa_s",
                        json["preset"].dump());
    former = {"preset", "stiffness"};
  }
  MatterScene scene;
  if (json.is_object() && json.contains("matter"))
    readSettings(path, {{"matter", json["matter"]}}, sceneSettings(), scene);
  scene = usualScene(scene.matter);
  readSettings(path, json, sceneSettings(), scene, former);
  return scene;
}

MatterScene parseMatterScene(std::string_view json) {
  const auto parsed = SettingsJson::parse(json, nullptr, false);
  if (parsed.is_discarded()) throw Error("is not valid JSON");
  if (!parsed.is_object()) throw Error("is not a JSON object");
  for (const SceneSetting& each : sceneSettings())
    if (each.required && !parsed.contains(std::string(each.setting.name)))
      throw ConfigError(each.setting.name, "is missing");
  const MatterScene scene = readScene("", parsed);
  requireBelonging(parsed, scene);
  if (parsed.contains("model") && scene.model.empty()) throw ConfigError("model", "is empty, not the name of a file");
  return scene;
}

MatterScene readMatterScene(const std::filesystem::path& file) {
  ChunkedFile in(file);
  const auto bytes = in.peek(kMaxSceneFile + 1);
  if (bytes.size() > kMaxSceneFile) throw FileError(file, "is too long for a scene of matter");
  try {
    MatterScene scene = parseMatterScene({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    if (!scene.model.empty() && !isBuiltInModel(scene.model)) scene.model = (file.parent_path() / scene.model).string();
    planOf(scene);
    return scene;
  } catch (const Error& error) {
    throw FileError(file, error.what());
  }
}

}  // namespace palpate
