// Attributes and indices of the parts of a glTF mesh, compressed or not.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/io/gltf_file.hpp"
#include "engine/io/texture.hpp"
#include "engine/io/unpacked_mesh.hpp"

namespace palpate {

/// Textures of the base colours of glTF materials.
/// Use of a texture by a material.
struct GltfTexture {
  std::uint32_t number = kNoTexture;  ///< index into GltfTextures::textures()
  std::string coordinates;            ///< attribute that contains the coordinates: "TEXCOORD_0"
  DVec2 shift{0}, scale{1};           ///< KHR_texture_transform
  double rotation_rad = 0;

  Vec2 transformed(const DVec2& uv) const;
};

class GltfTextures {
 public:
  explicit GltfTextures(GltfFile& file) : file_(file) {}

  /// The texture that "baseColorTexture" of a material states; nothing if it cannot be read, which lost() names.
  std::optional<GltfTexture> of(const nlohmann::json& stated);
  const std::vector<Texture>& textures() const { return textures_; }
  const std::vector<std::string>& lost() const { return lost_; }

 private:
  std::uint32_t numberOf(std::size_t which);

  GltfFile& file_;
  std::vector<Texture> textures_;
  std::map<std::size_t, std::uint32_t> numbers_;  // by entry of "textures"
  std::vector<std::string> lost_;
};

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
