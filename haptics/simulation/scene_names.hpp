// Scenes of matter as models, by their names.
#pragma once

#include <optional>
#include <string>

#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// The scene of that name: a built-in one, a closed cloud in place of a built-in body ("bunny.ply in water", "soft
/// bunny.ply"), or else a JSON file. Throws FileError, and Error as planOf() does.
MatterScene readSceneNamed(const std::string& name);

/// The scene that a model's name stands for, with a tool for each hand: a built-in one, unless there is a file of that
/// name, or that of a .json file. Empty if the model is something else. Throws as readSceneNamed().
std::optional<MatterScene> matterScene(const std::string& model);

/// Layers of particles and the volume that they fill, as in "8 x 9 x 8 layers fill 80 x 85 x 80 mm, 0.544 litres"; for
/// water or sand.
std::string layersInWords(const MatterScene& scene);
/// The elasticity of a soft body in words: its material.
std::string elasticityInWords(const MatterScene& scene);

}  // namespace palpate
