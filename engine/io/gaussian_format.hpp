// Scenes of 3D Gaussians as one of the formats.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// PLY files whose points have `scale_0` and `rot_0`. Reading gives the Gaussians' surface (surfaceOf()), with normals
/// and colours; a pipe cannot be recognised, and is read as plain PLY. Writing converts points to Gaussians
/// (gaussian_writer.hpp).
CloudFormat gaussianFormat();

}  // namespace palpate
