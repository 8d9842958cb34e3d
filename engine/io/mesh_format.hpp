// Triangle meshes, OBJ, STL, OFF and glTF, as formats: read, they become points that are sampled from them; the first
// three are written where there are triangles.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// Points that a mesh becomes where nobody says how many.
inline constexpr std::size_t kUsualSamples = 500'000;

CloudFormat objFormat();
CloudFormat stlFormat();
CloudFormat offFormat();
CloudFormat gltfFormat();  ///< is only read; GLB as well

}  // namespace palpate
