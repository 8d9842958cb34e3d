// Triangle meshes from files, as ground truth of a surface.
#pragma once

#include <filesystem>

#include "engine/cloud/triangle_mesh.hpp"

namespace palpate {

/// Reads vertices and faces. Throws FileError, also for a file without faces, and Error if no face has an area.
TriangleMesh readTriangleMesh(const std::filesystem::path& file);

}  // namespace palpate
