// Scenes of matter in JSON files.
#pragma once

#include <filesystem>
#include <string_view>

#include "engine/io/setting_json.hpp"
#include "engine/matter/matter_scene.hpp"
#include "engine/matter/scene_settings.hpp"

namespace palpate {

/// {"matter": "water", "box_mm": [x, y, z], "fill_mm": [x, y, z], "spacing_mm": s, …}: the fields of MatterScene under
/// their names, "tool" with "radius_mm" and "mass_kg", "pinned_mm" with two corners. "matter", "box_mm", "fill_mm" and
/// "spacing_mm" are required; a key that is unknown, or belongs to another kind of matter, is rejected. Throws Error
/// that begins with the field.
MatterScene parseMatterScene(std::string_view json);

/// Reads a scene from a file, and checks with planOf() that it can be simulated. "model" is relative to the file; the
/// scene stores the resulting path. Throws FileError with the field.
MatterScene readMatterScene(const std::filesystem::path& file);

/// A scene of matter as a part of a JSON text.
/// Reads a scene; settings that are missing have the defaults of its kind of matter. Throws ConfigError.
MatterScene readScene(std::string_view path, const SettingsJson& json);

}  // namespace palpate
