#include "engine/io/ply_reader.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/ply_body.hpp"
#include "engine/io/ply_vertices.hpp"
#include "engine/io/texture.hpp"

namespace palpate {

namespace {

// Colours of a PLY file's textures, which its comments name as MeshLab writes them.

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

/// The textures of "comment TextureFile NAME", in files beside `file`.
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

/// Gives the points of a cloud without colours those of its textures, at the coordinates that its attributes contain
/// ("s" and "t", "u" and "v", "texture_u" and "texture_v"), or else at `spots`, those of its faces, by point. Returns
/// the textures that are not used, with the reason.
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

std::string namesOf(const std::vector<PlyElement>& elements) {
  std::string names;
  for (const PlyElement& element : elements) names += (names.empty() ? "" : ", ") + element.name;
  return names.empty() ? "none" : names;
}

void remarkOnLostElements(const PlyInfo& info, const std::filesystem::path& path, Log* log) {
  std::string lost;
  for (const PlyElement& element : info.elements) {
    if (element.name == "vertex" || element.count == 0) continue;
    lost += fmt::format("{}{} {}", lost.empty() ? "" : ", ", element.count, element.name);
  }
  if (!lost.empty()) log->warn("{}: only the points are kept, not: {}", path.filename().string(), lost);
}

}  // namespace

PointCloud readPly(const std::filesystem::path& path, Log* log, PlyReadOptions options) {
  ChunkedFile file(path);
  if (log) file.onProgress([&](double share) { log->progress(path.filename().string(), share); });
  const PlyInfo info = readPlyHeader(file);
  if (options.info) *options.info = info;
  const PlyElement* vertex = info.find("vertex");
  if (!vertex) {
    throw FileError::atLine(path, file.line(),
                            fmt::format("no element 'vertex'; elements: {}", namesOf(info.elements)));
  }
  PlyVertices vertices(path, *vertex, log);
  std::optional<PlyFaces> faces;
  const std::vector<Texture> textures = texturesOf(info, path);
  const bool coordinates = !textures.empty() && std::ranges::any_of(info.elements, [](const PlyElement& element) {
    return PlyFaces::coordinateList(element) != nullptr;
  });
  if (options.normalsFromFaces || options.triangles || coordinates) faces.emplace(vertex->count);
  if (coordinates) faces->collectCoordinates();
  readPlyBody(file, info, vertices, faces ? &*faces : nullptr, log);
  if (log && !options.info) remarkOnLostElements(info, path, log);

  PointCloud cloud = vertices.finish(log);
  cloud.storedAs.comments = info.comments;
  if (faces) faces->cutPolygons(cloud, vertices.leftOut());
  const std::size_t gone = faces ? faces->leaveOut(vertices.leftOut()) : 0;
  if (options.leftOutRows) *options.leftOutRows = vertices.leftOut();
  if (options.lost) {
    *options.lost = vertices.lost();
    if (gone > 0) options.lost->push_back(fmt::format("{} of points that are left out", counted(gone, "triangle")));
  }
  if (!textures.empty())
    for (std::string& what :
         colorByTextures(cloud, textures, faces ? faces->spots(vertices.leftOut()) : std::vector<TextureSpot>())) {
      if (log && !options.info) log->warn("{}: not kept: {}", path.filename().string(), what);
      if (options.lost) options.lost->push_back(std::move(what));
    }
  if (options.normalsFromFaces) faces->applyTo(cloud, path, log);
  if (options.triangles)
    for (const auto& [a, b, c] : faces->triangles())
      options.triangles->push_back(
          {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
  return cloud;
}

}  // namespace palpate
