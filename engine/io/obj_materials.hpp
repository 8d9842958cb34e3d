// Materials of OBJ (MTL): their colours and textures.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/vec.hpp"
#include "engine/io/texture.hpp"

namespace palpate {

struct ObjMaterial {
  std::string name;
  std::optional<DVec3> color = {};      ///< Kd, 0 to 1
  std::optional<Texture> texture = {};  ///< map_Kd
  Vec2 scale{1}, shift{0};              ///< of coordinates of the texture
  bool isUsed = false;
  std::uint32_t number = kNoTexture;  ///< index of the texture among those of the mesh

  /// Many programs write a grey Kd beside a texture that is not to be darkened.
  DVec3 shown() const {
    const DVec3 own = color.value_or(DVec3(1));
    return texture && own.x == own.y && own.y == own.z ? DVec3(1) : own;
  }
};

/// Materials may be repeated. Throws FileError.
std::vector<ObjMaterial> readObjMaterials(const std::filesystem::path& file);

}  // namespace palpate
