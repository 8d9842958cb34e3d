// From the Gaussians of a file, whatever its format, to the points of their surface.
#pragma once

#include "engine/cloud/gaussian_scene.hpp"
#include "engine/io/cloud_format.hpp"

namespace palpate {

/// "300 Gaussians".
std::string gaussiansInWords(std::uint64_t count);

/// Gaussians whose numbers are not finite, or whose rotation is none, are left out, counted and named as lost. `scene`:
/// may have such. Says through `log` what became of them.
StoredCloud surfaceOfGaussians(const std::string& name, GaussianScene scene, Log* log);

}  // namespace palpate
