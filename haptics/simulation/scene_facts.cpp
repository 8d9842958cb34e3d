#include <fmt/ranges.h>

#include "engine/core/named_values.hpp"
#include "engine/matter/scene_settings.hpp"
#include "haptics/session/setting_facts.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

std::vector<SceneSettingFacts> sceneSettingFacts() {
  std::vector<SceneSettingFacts> all;
  for (const SceneSetting& each : sceneSettings()) {
    std::vector<std::string_view> kinds;
    for (const auto& [name, matter] : kMatters)
      if (each.isOf(matter)) kinds.push_back(name);
    const std::string of = kinds.size() == kMatters.size() ? "all" : fmt::format("{}", fmt::join(kinds, ", "));
    all.push_back({factsOf("matter", each.setting, MatterScene{}), of, each.required});
  }
  return all;
}

}  // namespace palpate
