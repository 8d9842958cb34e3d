// The points of a dense COLMAP reconstruction as one of the formats.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// A PLY file with NAME.ply.vis beside it, as COLMAP's stereo fusion writes both. It is read as PLY; its normals are
/// turned to the images that saw their points, and where it has none they are those of normalsFromViews(). The images
/// are those of the model in the folder `sparse` beside it, or in its own; where there is none, it is said, and the
/// file is read as PLY alone. Never written; what palpate saved under such a name is plain PLY, whose points are
/// others.
CloudFormat colmapDenseFormat();

}  // namespace palpate
