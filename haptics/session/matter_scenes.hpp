// A scene of matter as the model, by its name.
#pragma once

#include <optional>
#include <string>

#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// One that is built in, a closed cloud in its place ("bunny.ply in water", "soft bunny.ply"), or else a JSON file.
/// Throws FileError, and Error as planOf() does.
MatterScene readSceneNamed(const std::string& name);

/// What a model's name says of matter: a scene that is built in, where no file has its name, or in a .json file, with a
/// tool for each hand. Nothing where the model is something else. Throws as readSceneNamed().
std::optional<MatterScene> matterScene(const std::string& model);

/// The names of those that need no JSON file, as in "water, dam, sand".
std::string builtInScenes();
/// How many layers of particles fill what, as in "8 x 9 x 8 layers fill 80 x 85 x 80 mm, 0.544 litres"; of water or
/// sand.
std::string layersInWords(const MatterScene& scene);
/// What brings a soft body back to its shape: its material, or that it has none.
std::string elasticityInWords(const MatterScene& scene);

}  // namespace palpate
