#include "engine/io/triangle_mesh_file.hpp"

#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"

namespace palpate {

TriangleMesh readTriangleMesh(const std::filesystem::path& file) {
  const StoredCloud stored = readCloud(file, nullptr, {.asTriangles = true});
  std::vector<DVec3> vertices(stored.cloud.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = stored.cloud.fileCoordinates(i);
  if (stored.triangles.empty()) throw FileError(file, "has no faces; a mesh is needed here");
  return {vertices, stored.triangles};
}

}  // namespace palpate
