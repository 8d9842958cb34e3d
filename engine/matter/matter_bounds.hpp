// Checks of the fields of scenes: each throws an Error that begins with the field and states its bounds.
#pragma once

#include <string_view>

#include "engine/matter/matter_scene.hpp"

namespace palpate {

void requireBetween(std::string_view field, double value, double least, double most);
/// The same for each axis.
void requireBetween(std::string_view field, const DVec3& value, double least, const DVec3& most);

/// Checks that the scene's substeps suffice and do not exceed the maximum. `remedy`: what else reduces them, besides a
/// larger spacing.
void requireSubsteps(const MatterScene& scene, double needed, std::string_view remedy);

}  // namespace palpate
