#include "engine/core/error.hpp"
#include "engine/io/mesh_import.hpp"

namespace palpate {

bool canImportMeshes() { return false; }

ImportedMesh importMesh(const std::filesystem::path& file, const std::string&) {
  throw FileError(file,
                  "meshes are read by the library assimp, without which this program was built; sample it to points "
                  "elsewhere, or build it with libassimp-dev");
}

}  // namespace palpate
