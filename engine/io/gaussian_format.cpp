#include "engine/io/gaussian_format.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/cloud/gaussian_columns.hpp"
#include "engine/core/error.hpp"
#include "engine/io/gaussian_cloud.hpp"
#include "engine/io/gaussian_rows.hpp"
#include "engine/io/gaussian_writer.hpp"
#include "engine/io/ply_body.hpp"

namespace palpate {

namespace {

std::size_t restsOf(const PlyElement& vertex) {
  return static_cast<std::size_t>(std::ranges::count_if(
      vertex.properties, [](const PlyProperty& property) { return property.name.starts_with(kRestName); }));
}

bool holdsGaussians(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  try {
    const PlyInfo info = readPlyInfo(path);
    const PlyElement* vertex = info.find("vertex");
    return vertex && GaussianRows::areGaussians(*vertex);
  } catch (const FileError&) {  // the reader reports the error
    return false;
  }
}

FileContents contentsOfGaussians(const std::filesystem::path& file) {
  const PlyInfo info = readPlyInfo(file);
  FileContents contents{.elements = {}, .comments = info.comments};
  for (const PlyElement& element : info.elements) {
    const bool gaussians = element.name == "vertex";
    FileElement& known = contents.elements.emplace_back();
    known.name = gaussians ? "Gaussian" : element.name;
    known.count = element.count;
    for (const PlyProperty& property : element.properties) known.properties.push_back({property.name, property.isList});
    if (gaussians)
      contents.madeFrom = fmt::format("a splat scene of {}; the points are those of their surface",
                                      gaussiansInWords(element.count, restsOf(element)));
  }
  return contents;
}

std::vector<std::string> lostOf(const PlyInfo& info, const GaussianRows& rows) {
  std::vector<std::string> lost;
  for (const PlyElement& element : info.elements)
    if (element.count > 0 && element.name != "vertex")
      lost.push_back(fmt::format("{} {}", element.count, element.name));
  for (const std::string& name : rows.lists()) lost.push_back(fmt::format("property '{}' of vertex", name));
  return lost;
}

StoredCloud readGaussians(const std::filesystem::path& path, Log* log, const CloudReadOptions& options) {
  const std::string name = path.filename().string();
  ChunkedFile file(path);
  if (log) file.onProgress([&](double share) { log->progress(name, share); });
  const PlyInfo info = readPlyHeader(file);
  const PlyElement* vertex = info.find("vertex");
  if (!vertex) throw FileError::atLine(path, file.line(), "no element 'vertex'");
  GaussianRows rows(path, *vertex);
  readPlyBody(file, info, rows, nullptr, log);
  if (log && options.normalsFromFaces) log->say("{}: has no faces to take normals from", name);

  std::vector<std::string> lost = lostOf(info, rows);
  auto records = rows.takeRecords();
  StoredCloud stored = surfaceOfGaussians(name, sceneOf(*records), log);
  stored.lost = std::move(lost);  // Gaussians that are not felt are kept with the others
  stored.cloud.storedAs.baggage = std::move(records);
  stored.cloud.storedAs.comments = info.comments;
  return stored;
}

}  // namespace

CloudFormat gaussianFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".3dgs.ply"};
  return {.name = "3DGS",
          .endings = kEndings,
          .holds = holdsGaussians,
          .contents = contentsOfGaussians,
          .read = readGaussians,
          .write = writeGaussians,
          .lacks = lacksOfGaussians,
          .attributes = [](const PointCloud&) { return std::vector<const Attribute*>{}; },
          .hasComments = true,
          .onlyCopied = true};
}

}  // namespace palpate
