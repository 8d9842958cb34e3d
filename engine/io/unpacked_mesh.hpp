// Meshes that are compressed by Draco, as in glTF (KHR_draco_mesh_compression).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

struct UnpackedMesh {
  struct Attribute {
    std::uint32_t id = 0;
    unsigned kind = 0;  ///< component type of glTF
    unsigned perElement = 0;
    std::vector<std::byte> bytes;  ///< elements one after the other
  };

  std::size_t corners = 0;
  std::vector<Attribute> attributes;
  std::vector<std::uint32_t> indices;  ///< three for each triangle
};

/// Throws Error if the bytes are damaged, or the library is not built in.
UnpackedMesh unpackMesh(std::span<const std::byte> bytes);

}  // namespace palpate
