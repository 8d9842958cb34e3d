#pragma once

#include <vector>

#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// Pressure of water about `place`, as MatterSimulation::pressureAt() says. `particles`: m, in any order; the
/// compression in w.
double waterPressure(const MatterScene& scene, const MatterPlan& plan, const std::vector<Vec4>& particles,
                     const DVec3& place);

}  // namespace palpate
