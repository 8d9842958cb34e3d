// Scenes of 3D Gaussians as one of the formats.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// PLY files whose points have `scale_0` and `rot_0`; read only. The cloud is the Gaussians' surface (surfaceOf()),
/// with normals and colours. A pipe cannot be recognised, and is read as plain PLY.
CloudFormat gaussianFormat();

}  // namespace palpate
