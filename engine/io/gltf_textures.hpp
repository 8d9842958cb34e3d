// Textures of the base colours of glTF materials.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/io/gltf_file.hpp"
#include "engine/io/texture.hpp"

namespace palpate {

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

}  // namespace palpate
