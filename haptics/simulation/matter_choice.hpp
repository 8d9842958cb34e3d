// A scene of matter as the scene of a session.
#pragma once

#include "engine/matter/matter_scene.hpp"
#include "haptics/session/simulated_scene.hpp"

namespace palpate {

SceneRef sceneRef(MatterScene scene);
/// The scene of matter behind a scene of a session.
const MatterScene& matterOf(const SceneRef& scene);

}  // namespace palpate
