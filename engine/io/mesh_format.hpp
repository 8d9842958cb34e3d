// Triangle meshes (OBJ, STL, OFF and glTF) as formats: reading samples points from them; the first three can be written
// if there are triangles.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

/// Default number of points sampled from a mesh.
inline constexpr std::size_t kUsualSamples = 500'000;

CloudFormat objFormat();
CloudFormat stlFormat();
CloudFormat offFormat();
CloudFormat gltfFormat();  ///< read only; GLB as well

}  // namespace palpate
