// Replaces haptics/simulation if palpate is built without PALPATE_SIMULATION.
#include "haptics/session/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "engine/core/error.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

namespace {

[[noreturn]] void refuse(std::string_view what) {
  throw NotBuilt(fmt::format("{} is a simulated scene and", what), "PALPATE_SIMULATION");
}

// Words alone, as in "soft statue", which no file and no device has as its name.
bool isInWords(const std::string& model) {
  const auto isLetter = [](char c) { return (c >= 'a' && c <= 'z') || c == ' '; };
  std::error_code ignored;
  return !model.empty() && std::ranges::all_of(model, isLetter) && !std::filesystem::exists(model, ignored);
}

}  // namespace

bool canSimulate() { return false; }

SceneRef sceneNamed(const std::string& model) {
  if (std::filesystem::path(model).extension() == ".json") refuse(model);
  if (isInWords(model))
    throw NotBuilt(fmt::format("{}: there is no such file, and a simulated scene", model), "PALPATE_SIMULATION");
  return {};
}

std::string builtInScenes() { return {}; }
std::vector<std::string> builtInSceneNames() { return {}; }
bool isBuiltInScene(std::string_view) { return false; }
SceneRef parseScene(std::string_view path, std::string_view) { refuse(path); }
std::vector<SceneSettingFacts> sceneSettingFacts() { return {}; }
void takeFarScene(Model&, FarPoints&, const FarFacts&, const ModelLoading&) { refuse("the served model"); }
std::unique_ptr<Simulator> cpuSimulator() { return nullptr; }

}  // namespace palpate
