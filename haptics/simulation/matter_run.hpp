// Matter without hands, for programs.
#pragma once

#include <memory>

#include "engine/matter/matter_simulation.hpp"
#include "haptics/session/simulated_scene.hpp"

namespace palpate {

std::unique_ptr<FreeSimulation> runFreely(std::unique_ptr<MatterSimulation> world);

}  // namespace palpate
