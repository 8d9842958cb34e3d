#include "engine/io/mesh_writer.hpp"

#include <limits>

#include <glm/geometric.hpp>

#include "engine/core/error.hpp"
#include "engine/io/row_output.hpp"

namespace palpate {

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

const Triangles& trianglesOf(const std::filesystem::path& path, const CloudWriteOptions& options) {
  if (!options.triangles || options.triangles->empty())
    throw FileError(path, "this format contains only triangles, and there are none; name the file .ply");
  return *options.triangles;
}

void place(RowOutput& out, const DVec3& p, bool doubles) {
  for (int k = 0; k < 3; ++k) out.real(doubles ? ScalarType::f64 : ScalarType::f32, p[k]);
}

/// Whether positions need more than single precision.
bool isWide(const PointCloud& cloud, const CloudWriteOptions& options) {
  return options.doubles || cloud.origin != DVec3(0) || !cloud.exactPositions.empty();
}

void putFacet(RowOutput& out, const std::array<DVec3, 3>& corners, const Vec3& normal, bool ascii) {
  const auto numbers = [&](const char* word, const Vec3& v) {
    if (ascii) return out.headerLine(fmt::format("{}{} {} {}", word, v.x, v.y, v.z));
    for (int k = 0; k < 3; ++k) out.value(v[k]);
  };
  numbers("facet normal ", normal);
  if (ascii) out.headerLine("outer loop");
  for (const DVec3& corner : corners) numbers("vertex ", Vec3(corner));
  if (ascii)
    out.headerLine("endloop\nendfacet");
  else
    out.value(std::uint16_t{0});
}

std::vector<std::string> lacksOfMesh(const PointCloud& cloud, bool normals, bool colors) {
  std::vector<std::string> lost;
  if (!normals && cloud.hasNormals()) lost.emplace_back("normals of corners");
  if (!colors && cloud.hasColors()) lost.emplace_back("colours");
  if (colors && cloud.storedAs.alpha) lost.emplace_back("the alpha of colours");
  for (const Attribute& attribute : cloud.extra) lost.push_back(fmt::format("the attribute '{}'", attribute.name));
  return lost;
}

}  // namespace

void writeObj(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  const Triangles& triangles = trianglesOf(path, options);
  RowOutput out(path, true);
  for (const std::string& comment : cloud.storedAs.comments) out.headerLine("# " + comment);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    out.word("v");
    place(out, cloud.fileCoordinates(i), isWide(cloud, options));
    if (cloud.hasColors())
      for (std::size_t k = 0; k < 3; ++k) out.value(static_cast<float>(cloud.colors[i][k]) / 255.0f);
    out.endRow();
  }
  for (const Vec3& normal : cloud.normals) {
    out.word("vn");
    place(out, DVec3(normal), false);
    out.endRow();
  }
  for (const auto& triangle : triangles) {
    out.word("f");
    for (const std::uint32_t corner : triangle)
      out.word(cloud.hasNormals() ? fmt::format("{0}//{0}", corner + 1) : fmt::format("{}", corner + 1));
    out.endRow();
  }
  out.finish(options.keptAs);
}

void writeStl(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  const Triangles& triangles = trianglesOf(path, options);
  if (triangles.size() > std::numeric_limits<std::uint32_t>::max())
    throw FileError(path, "STL has at most 4,294,967,295 triangles");
  RowOutput out(path, options.ascii);
  if (options.ascii) {
    out.headerLine("solid palpate");
  } else {
    constexpr std::size_t kHead = 80;
    for (std::size_t k = 0; k < kHead / 8; ++k) out.value(std::uint64_t{0});
    out.value(static_cast<std::uint32_t>(triangles.size()));
  }
  for (const auto& triangle : triangles) {
    std::array<DVec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = cloud.fileCoordinates(triangle[k]);
    const DVec3 across = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double length = glm::length(across);
    putFacet(out, corners, length > 0 ? Vec3(across / length) : Vec3(0), options.ascii);
    if (!options.ascii) out.endRow();
  }
  if (options.ascii) out.headerLine("endsolid palpate");
  out.finish(options.keptAs);
}

void writeOff(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  const Triangles& triangles = trianglesOf(path, options);
  RowOutput out(path, true);
  out.headerLine("OFF");
  out.headerLine(fmt::format("{} {} 0", cloud.size(), triangles.size()));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    place(out, cloud.fileCoordinates(i), isWide(cloud, options));
    out.endRow();
  }
  for (const auto& triangle : triangles) {
    out.value(3);
    for (const std::uint32_t corner : triangle) out.value(corner);
    out.endRow();
  }
  out.finish(options.keptAs);
}

std::vector<std::string> lacksOfObj(const PointCloud& cloud) { return lacksOfMesh(cloud, true, true); }

std::vector<std::string> lacksOfStl(const PointCloud& cloud) {
  std::vector<std::string> lost = lacksOfMesh(cloud, false, false);
  if (isWide(cloud, {})) lost.emplace_back("coordinates finer than single precision");
  return lost;
}

std::vector<std::string> lacksOfOff(const PointCloud& cloud) { return lacksOfMesh(cloud, false, false); }

}  // namespace palpate
