#include "engine/io/obj_materials.hpp"

#include <algorithm>

#include "engine/io/mesh_lines.hpp"

namespace palpate {

namespace {

/// Reads the options of map_Kd; the name of the picture, which may contain blanks, follows them.
void readTexture(const MeshLines& lines, const std::filesystem::path& folder, ObjMaterial& material) {
  const auto& words = lines.words();
  Texture& texture = material.texture.emplace();
  std::size_t k = 1;
  while (k + 1 < words.size() && words[k].size() > 1 && words[k][0] == '-') {
    const std::string_view option = words[k++];
    if (option == "-s" || option == "-o" || option == "-t") {
      for (int axis = 0; axis < 3 && k + 1 < words.size(); ++axis, ++k) {
        const auto value = textNumber<float>(words[k]);
        if (!value) break;
        if (axis < 2 && option != "-t") (option == "-s" ? material.scale : material.shift)[axis] = *value;
      }
    } else {
      if (option == "-clamp" && words[k] == "on") texture.wrapU = texture.wrapV = TextureWrap::clamp;
      k += option == "-mm" ? 2 : 1;
    }
  }
  texture.name = lines.behind(std::min(k, words.size() - 1));
  texture.file = textureBeside(folder, texture.name);
}

}  // namespace

std::vector<ObjMaterial> readObjMaterials(const std::filesystem::path& file) {
  std::vector<ObjMaterial> materials;
  MeshLines lines(file);
  while (lines.next()) {
    const auto& words = lines.words();
    if (words.front() == "newmtl")
      materials.push_back({.name = lines.behind(1)});
    else if (words.front() == "Kd" && !materials.empty() && words.size() >= 4 && textNumber<double>(words[1]))
      materials.back().color = lines.three(1, "a colour");
    else if (words.front() == "map_Kd" && !materials.empty() && words.size() > 1)
      readTexture(lines, file.parent_path(), materials.back());
  }
  return materials;
}

}  // namespace palpate
