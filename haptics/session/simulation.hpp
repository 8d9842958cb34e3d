// The annex PALPATE_SIMULATION, or its absence (no_simulation.cpp): scenes by their names and texts, and simulators.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/setting.hpp"
#include "haptics/session/simulated_scene.hpp"

namespace palpate {

struct FarFacts;
struct FarPoints;

/// False if palpate was built without PALPATE_SIMULATION: a scene then causes a NotBuilt error.
bool canSimulate();

/// The scene that a model's name stands for, with a tool for each hand: a built-in one, unless there is a file of that
/// name, or that of a .json file. Empty if the model is something else. Throws FileError, NotBuilt, and Error for what
/// cannot be simulated.
SceneRef sceneNamed(const std::string& model);
/// Names of the scenes that require no JSON file, as in "water, dam, sand", for a help text; empty if there are none.
std::string builtInScenes();
std::vector<std::string> builtInSceneNames();
bool isBuiltInScene(std::string_view name);

/// Reads a scene from SimulatedScene::text(); `path` names it in errors. Throws ConfigError, NotBuilt.
SceneRef parseScene(std::string_view path, std::string_view text);

/// A setting of a scene, for a reference page.
struct SceneSettingFacts : SettingFacts {
  std::string of;  ///< the scenes that have it
  bool required = false;
};
/// All settings of scenes, in the order of their JSON.
std::vector<SceneSettingFacts> sceneSettingFacts();

/// Particles that another program simulates: takes the scene from the facts, and the body that stands in it from the
/// last points of `model`. Throws Error.
void takeFarScene(Model& model, FarPoints& far, const FarFacts& facts, const ModelLoading& loading);

/// Null without the annex.
std::unique_ptr<Simulator> cpuSimulator();

}  // namespace palpate
