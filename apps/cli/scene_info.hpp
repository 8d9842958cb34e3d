#pragma once

#include <string>

#include "apps/cli/context.hpp"
#include "haptics/session/simulated_scene.hpp"

namespace palpate {

/// `palpate info` of a simulated scene. Of the annex PALPATE_SIMULATION.
void infoOfScene(Context& context, const std::string& name, const SceneRef& scene);

}  // namespace palpate
