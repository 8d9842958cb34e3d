// Reads triangle meshes: OBJ (Wavefront), STL (3D Systems), OFF (Geomview) and glTF 2.0 (Khronos).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/io/triangle_soup.hpp"

namespace palpate {

struct ImportedMesh {
  TriangleSoup soup;
  std::vector<std::string> lost;  ///< contents of the file other than triangles, in words
  /// For a format that does not state how much there is: number of the last line, if it has no end.
  std::uint64_t openLine = 0;
};

/// All of them throw FileError with the line or the byte, and allocate memory for data present in the file, not for
/// what it claims.

/// Reads positions, and normals and colours if all corners have them. Polygons become triangles.
ImportedMesh importObj(const std::filesystem::path& file);
/// Binary or text; triangles do not share corners, and normals of the file are not used.
ImportedMesh importStl(const std::filesystem::path& file);
/// Text, with normals and colours of corners (NOFF, COFF). Polygons become triangles.
ImportedMesh importOff(const std::filesystem::path& file);
/// JSON with embedded or separate buffers, or GLB: each mesh at all positions where the nodes of its scene place it.
ImportedMesh importGltf(const std::filesystem::path& file);

}  // namespace palpate
