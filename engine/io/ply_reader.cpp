#include "engine/io/ply_reader.hpp"

#include <algorithm>
#include <optional>

#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/ply_body.hpp"
#include "engine/io/ply_textures.hpp"
#include "engine/io/ply_vertices.hpp"

namespace palpate {
namespace {

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
