// The points of a dense COLMAP reconstruction as one of the formats.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// A PLY file with NAME.ply.vis beside it, both written by COLMAP's stereo fusion. It is read as PLY; its normals are
/// oriented towards the images that saw their points, or computed by normalsFromViews() if missing. The images are
/// those of the model in the folder `sparse` beside it, or in its own folder; without a model this is logged, and the
/// file is read as plain PLY. Never written; a file that palpate saved under such a name is plain PLY with other
/// points.
CloudFormat colmapDenseFormat();

}  // namespace palpate
