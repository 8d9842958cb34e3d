// A scene of matter as a part of a JSON text.
#pragma once

#include "engine/io/setting_json.hpp"
#include "engine/matter/scene_settings.hpp"

namespace palpate {

/// Reads a scene; settings that are missing have the defaults of its kind of matter. Throws ConfigError.
MatterScene readScene(std::string_view path, const SettingsJson& json);

}  // namespace palpate
