// Gaussian splats packed for the web: SuperSplat's compressed PLY (PlayCanvas 2023, "Compressing Gaussian splats"),
// antimatter15's .splat (2023) and Niantic's SPZ, versions 2 and 3 (2024, the README of nianticlabs/spz).
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// All three are read only. As with gaussianFormat(), the cloud is the Gaussians' surface.
CloudFormat compressedPlyFormat();
CloudFormat splatFormat();
CloudFormat spzFormat();

}  // namespace palpate
