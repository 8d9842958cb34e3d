// Scenes of matter, as JSON files say them.
#pragma once

#include <filesystem>
#include <string_view>

#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// {"matter": "water", "box_mm": [x, y, z], "fill_mm": [x, y, z], "spacing_mm": s, …}: the fields of MatterScene under
/// their names, "tool" with "radius_mm" and "mass_kg", "pinned_mm" with two corners. "matter", "box_mm", "fill_mm" and
/// "spacing_mm" are needed; a key that is not known, or belongs to another kind of matter, is refused. Throws Error
/// that begins with the field.
MatterScene parseMatterScene(std::string_view json);

/// The same of a file, which can be simulated: planOf() has passed it. "model" is relative to the file, and a scene has
/// the name of the file that it leads to. Throws FileError with the field.
MatterScene readMatterScene(const std::filesystem::path& file);

}  // namespace palpate
