// Parameters of a scene that can be changed while it runs: numbers that change no particle's position.
#pragma once

#include <string_view>
#include <vector>

#include "engine/core/simulation_control.hpp"
#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// The parameters of the scene's matter, named by the scene's fields; one gravity parameter per axis.
std::vector<SimulationParameter> parametersOf(const MatterScene& scene);

/// Throws Error with the valid names, or the bounds; does not check the limits of planOf().
void setParameter(MatterScene& scene, std::string_view name, double value);

}  // namespace palpate
