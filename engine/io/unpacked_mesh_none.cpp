#include "engine/core/error.hpp"
#include "engine/io/unpacked_mesh.hpp"

namespace palpate {

UnpackedMesh unpackMesh(std::span<const std::byte>) {
  throw Error(
      "this compression needs the library Draco, which was not found when palpate was built; export it without "
      "compression, or as PLY or OBJ");
}

}  // namespace palpate
