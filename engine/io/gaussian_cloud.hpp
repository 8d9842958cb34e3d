// Converts the Gaussians of a file of any format to points of their surface.
#pragma once

#include "engine/cloud/gaussian_scene.hpp"
#include "engine/io/cloud_format.hpp"

namespace palpate {

/// Gaussians with numbers that are not finite, or with a zero rotation, are left out, counted and named as lost;
/// `scene` may contain such. Logs the result.
StoredCloud surfaceOfGaussians(const std::string& name, GaussianScene scene, Log* log);

}  // namespace palpate
