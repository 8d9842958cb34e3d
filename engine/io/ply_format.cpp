#include "engine/io/known_formats.hpp"

#include <fmt/format.h>

#include "engine/core/counted.hpp"
#include "engine/io/gaussian_writer.hpp"
#include "engine/io/ply_faces.hpp"
#include "engine/io/ply_reader.hpp"
#include "engine/io/ply_writer.hpp"

namespace palpate {

namespace {

// Names what is lost of an element: its other properties if it has triangles, else the whole element.
void nameLostOf(const PlyElement& element, std::vector<std::string>& lost) {
  if (element.count == 0) return;
  const bool vertex = element.name == "vertex";
  const PlyProperty* indices = PlyFaces::indexList(element);
  if (!vertex && !indices) lost.push_back(fmt::format("{} {}", element.count, element.name));
  for (const PlyProperty& property : element.properties)
    if (&property != indices && (vertex ? property.isList : indices != nullptr))
      lost.push_back(fmt::format("property '{}' of {}", property.name, element.name));
}

std::vector<std::string> lostByReading(const PlyInfo& info, const StoredCloud& stored) {
  std::vector<std::string> lost;
  std::uint64_t faces = 0;
  for (const PlyElement& element : info.elements) {
    nameLostOf(element, lost);
    if (PlyFaces::indexList(element)) faces += element.count;
  }
  if (faces != stored.triangles.size() && stored.leftOutRows.empty())
    lost.push_back(fmt::format("the outlines of {}, which become {}", counted(faces, "face"),
                               counted(stored.triangles.size(), "triangle")));
  const StoredAs& as = stored.cloud.storedAs;
  if (stored.cloud.hasNormals() && as.normal == ScalarType::f64)
    lost.emplace_back("normals finer than single precision");
  return lost;
}

FileContents contentsOfPly(const std::filesystem::path& file) {
  PlyInfo info = readPlyInfo(file);
  FileContents contents{.elements = {}, .comments = std::move(info.comments)};
  for (PlyElement& element : info.elements) {
    FileElement& known = contents.elements.emplace_back(FileElement{std::move(element.name), element.count, {}});
    for (PlyProperty& property : element.properties)
      known.properties.push_back({std::move(property.name), property.isList});
  }
  return contents;
}

StoredCloud readPlyFile(const std::filesystem::path& file, Log* log, const CloudReadOptions& options) {
  StoredCloud stored;
  PlyInfo info;
  PlyReadOptions how{
      .normalsFromFaces = options.normalsFromFaces, .lost = &stored.lost, .leftOutRows = &stored.leftOutRows};
  if (!options.pointsOnly) {
    how.triangles = &stored.triangles;
    how.info = &info;
  }
  stored.cloud = readPly(file, log, how);
  if (options.pointsOnly) return stored;
  for (std::string& what : lostByReading(info, stored)) stored.lost.push_back(std::move(what));
  return stored;
}

void write(const std::filesystem::path& file, const PointCloud& cloud, const CloudWriteOptions& options) {
  if (const GaussianRecords* const records = gaussiansOf(cloud))
    return writeRecords(file, *records, cloud.storedAs.comments, options);
  writePly(file, cloud, options);
}

std::vector<std::string> lacksOfPly(const PointCloud& cloud) {
  if (gaussiansOf(cloud)) return lacksOfGaussians(cloud);
  std::vector<std::string> lost;
  for (const std::string& name : namesGivingWay(cloud))
    lost.push_back(fmt::format("property '{}' of vertex, because another one is written under its name", name));
  return lost;
}

}  // namespace

CloudFormat plyFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".ply"};
  return {.name = "PLY",
          .endings = kEndings,
          .begins = [](const FileStart& start) { return start.startsWith("ply\n") || start.startsWith("ply\r"); },
          .contents = contentsOfPly,
          .read = readPlyFile,
          .write = write,
          .lacks = lacksOfPly,
          .hasComments = true,
          .family = "3DGS",  // the Gaussians of a splat scene
          .keepsTriangles = true};
}

}  // namespace palpate
