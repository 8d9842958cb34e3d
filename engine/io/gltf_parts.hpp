// Attributes and indices of the parts of a glTF mesh, compressed or not.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "engine/io/gltf_file.hpp"
#include "engine/io/unpacked_mesh.hpp"

namespace palpate {

class GltfParts {
 public:
  /// The indices of such a part are those of triangles, whatever its mode was.
  static constexpr const char* kDraco = "KHR_draco_mesh_compression";

  explicit GltfParts(GltfFile& file) : file_(file) {}

  /// Numbers of an attribute that `primitive` has; valid as long as this object. Throws FileError.
  GltfNumbers attribute(const nlohmann::json& primitive, const char* name, std::initializer_list<unsigned> perElement);
  /// Nothing if there are none.
  std::optional<GltfNumbers> indices(const nlohmann::json& primitive);

 private:
  /// Null if the part is not compressed by Draco.
  const UnpackedMesh* unpacked(const nlohmann::json& primitive);

  GltfFile& file_;
  std::map<std::size_t, UnpackedMesh> unpacked_;  // by view
};

}  // namespace palpate
