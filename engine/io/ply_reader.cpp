#include "engine/io/ply_reader.hpp"

#include <bit>
#include <optional>

#include "engine/core/error.hpp"
#include "engine/io/ply_body.hpp"

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
  if (!lost.empty()) log->say("{}: only the points are kept, not: {}", path.filename().string(), lost);
}

/// Says when something follows the last element; blank lines do not count.
void remarkOnRest(ChunkedFile& file, Log* log) {
  const std::uint64_t offset = file.offset();
  const auto rest = file.peek(1);
  for (const std::byte b : rest) {
    if (b == std::byte{'\n'} || b == std::byte{'\r'} || b == std::byte{' '}) continue;
    log->say("{}: what follows the last element, from byte {} on, is ignored", file.path().filename().string(), offset);
    return;
  }
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
  const bool ascii = info.format == PlyFormat::ascii;
  const bool littleEndian = info.format == PlyFormat::binaryLittleEndian;
  const bool swapBytes = littleEndian != (std::endian::native == std::endian::little);

  PlyVertices vertices(path, *vertex, log);
  std::optional<PlyFaces> faces;
  if (options.normalsFromFaces || options.triangles) faces.emplace(vertex->count);
  PlyFaces* const wanted = faces ? &*faces : nullptr;
  for (const PlyElement& element : info.elements) {
    const bool isVertex = &element == vertex;
    if (ascii)
      isVertex ? readAsciiVertices(file, element, vertices) : passAsciiElement(file, element, wanted);
    else
      isVertex ? readBinaryVertices(file, element, swapBytes, vertices)
               : passBinaryElement(file, element, swapBytes, wanted);
  }
  if (log) {
    if (!options.info) remarkOnLostElements(info, path, log);
    remarkOnRest(file, log);
  }

  PointCloud cloud = vertices.finish(log);
  cloud.storedAs.comments = info.comments;
  if (options.normalsFromFaces) faces->applyTo(cloud, path, log);
  if (options.triangles)
    for (const auto& [a, b, c] : faces->triangles())
      options.triangles->push_back(
          {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
  return cloud;
}

}  // namespace palpate
