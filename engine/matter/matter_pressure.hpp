#pragma once

#include <vector>

#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// Pressure of water at `place`, as in MatterSimulation::pressureAt(). `particles`: m, in any order; w: the
/// compression.
double waterPressure(const MatterScene& scene, const MatterPlan& plan, const std::vector<Vec4>& particles,
                     const DVec3& place);

}  // namespace palpate
