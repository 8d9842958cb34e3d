// Files of triangle meshes, read by the library assimp where the program was built with it.
#pragma once

#include <filesystem>
#include <string>

#include "engine/io/triangle_soup.hpp"

namespace palpate {

struct ImportedMesh {
  TriangleSoup soup;
  std::vector<std::string> lost;  ///< what of the file is no triangle, in words
};

/// Whether it was; otherwise importMesh() throws that it was not.
bool canImportMeshes();

/// `ending`: of the format, with the dot, whatever the file is called. Throws FileError: for what is no such file, for
/// one of more than 4 GiB, and where memory does not suffice.
ImportedMesh importMesh(const std::filesystem::path& file, const std::string& ending);

}  // namespace palpate
