// What of a scene can be changed while it runs: numbers that change no particle's place.
#pragma once

#include <string_view>
#include <vector>

#include "engine/core/simulation_control.hpp"
#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// Those that the matter of a scene has, by the names of its fields; gravity along each axis of its own.
std::vector<SimulationParameter> parametersOf(const MatterScene& scene);

/// Throws Error with the names that there are, or the bounds; what planOf() refuses is not looked at.
void setParameter(MatterScene& scene, std::string_view name, double value);

}  // namespace palpate
