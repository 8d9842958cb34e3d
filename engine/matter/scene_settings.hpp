// The table of all settings of a scene of matter, for its file, a configuration and a served scene alike.
#pragma once

#include "engine/core/setting.hpp"
#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// A setting of a scene, and the scenes that have it.
struct SceneSetting {
  Setting<MatterScene> setting;
  bool ofWater = true, ofSand = true, ofSoft = true;
  bool required = false;  ///< in a file

  operator const Setting<MatterScene>&() const { return setting; }
  bool isOf(Matter matter) const {
    return matter == Matter::water ? ofWater : matter == Matter::sand ? ofSand : ofSoft;
  }
};

std::span<const SceneSetting> sceneSettings();

/// The defaults of a kind of matter.
MatterScene usualScene(Matter matter);

}  // namespace palpate
