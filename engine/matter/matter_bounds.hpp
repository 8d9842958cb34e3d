// What the fields of scenes are held against: each throws Error that begins with the field and says its bounds.
#pragma once

#include <string_view>

#include "engine/matter/matter_scene.hpp"

namespace palpate {

void requireBetween(std::string_view field, double value, double least, double most);
void requireBetween(std::string_view field, const DVec3& value, double least, double most);
/// Along each axis.
void requireBetween(std::string_view field, const DVec3& value, double least, const DVec3& most);

/// Whether the scene's substeps are as many as it needs, and not too many. `remedy`: what else needs fewer, besides a
/// larger spacing.
void requireSubsteps(const MatterScene& scene, double needed, std::string_view remedy);

}  // namespace palpate
