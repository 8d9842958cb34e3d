#include "engine/io/ply_textures.hpp"

#include <algorithm>
#include <utility>

namespace palpate {

namespace {

const Attribute* named(const PointCloud& cloud, std::string_view name) {
  const auto found = std::ranges::find(cloud.extra, name, &Attribute::name);
  return found == cloud.extra.end() ? nullptr : &*found;
}

float numberOf(const Attribute& attribute, std::size_t i) {
  return visitScalar(attribute.type, [&]<class T>(std::type_identity<T>) {
    return static_cast<float>(loadScalar<T>(attribute.data.data() + i * sizeof(T)));
  });
}

/// Empty if points have no coordinates.
std::vector<TextureSpot> spotsOfPoints(const PointCloud& cloud) {
  constexpr std::pair<const char*, const char*> kNames[] = {
      {"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}};
  const Attribute* which = named(cloud, "texnumber");
  std::vector<TextureSpot> spots;
  for (const auto& [uName, vName] : kNames) {
    const Attribute *u = named(cloud, uName), *v = named(cloud, vName);
    if (!u || !v) continue;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      spots.push_back(
          {which ? static_cast<std::uint32_t>(numberOf(*which, i)) : 0, {numberOf(*u, i), numberOf(*v, i)}});
    break;
  }
  return spots;
}

}  // namespace

std::vector<Texture> texturesOf(const PlyInfo& info, const std::filesystem::path& file) {
  constexpr std::string_view kTexture = "comment TextureFile ";
  std::vector<Texture> textures;
  for (const std::string& comment : info.comments)
    if (comment.starts_with(kTexture)) {
      const std::string name = comment.substr(kTexture.size());
      textures.push_back({.file = textureBeside(file.parent_path(), name), .bytes = {}, .name = name});
    }
  return textures;
}

std::vector<std::string> colorByTextures(PointCloud& cloud, std::vector<Texture> textures,
                                         std::vector<TextureSpot> spots) {
  const bool hadColors = cloud.hasColors();
  if (std::vector<TextureSpot> own = hadColors ? std::vector<TextureSpot>() : spotsOfPoints(cloud); !own.empty())
    spots = std::move(own);
  std::vector<std::string> lost;
  if (hadColors || spots.empty()) {
    for (const Texture& texture : textures)
      lost.push_back(
          lostTexture(texture.name, hadColors ? "points have colours" : "points have no texture coordinates"));
    return lost;
  }
  for (TextureSpot& spot : spots) spot.uv.y = 1 - spot.uv.y;  // PLY counts v from the bottom
  cloud.colors.assign(cloud.size(), Rgba{255, 255, 255, 255});
  lost = multiplyByTextures(textures, spots, cloud.colors);
  if (lost.size() == textures.size()) cloud.colors.clear();
  return lost;
}

}  // namespace palpate
