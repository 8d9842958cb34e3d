// Reading triangle meshes: OBJ (Wavefront), STL (3D Systems), OFF (Geomview) and glTF 2.0 (Khronos).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/io/triangle_soup.hpp"

namespace palpate {

struct ImportedMesh {
  TriangleSoup soup;
  std::vector<std::string> lost;  ///< what of the file is no triangle, in words
};

/// All of them throw FileError with the line or the byte, and take memory for what a file has and not for what it says.

/// Places, and normals and colours where all corners have them. Polygons become triangles.
ImportedMesh importObj(const std::filesystem::path& file);
/// Binary or as text; corners of different triangles are different ones, and the normals that it gives are not used.
ImportedMesh importStl(const std::filesystem::path& file);
/// As text, with normals and colours of corners (NOFF, COFF). Polygons become triangles.
ImportedMesh importOff(const std::filesystem::path& file);
/// JSON with its buffers within or beside it, or GLB: each mesh wherever the nodes of its scene have it.
ImportedMesh importGltf(const std::filesystem::path& file);

}  // namespace palpate
