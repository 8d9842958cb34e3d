#include "engine/io/las_format.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "engine/core/system_file.hpp"
#include "engine/io/las_reader.hpp"
#include "engine/io/las_writer.hpp"

namespace palpate {

namespace {

/// By their first bytes, as compressed ones have another ending, and its reader says what they are.
bool holdsLas(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::FILE* file = openFile(path, "rb");
  if (!file) return false;
  std::array<char, 4> begin{};
  const bool whole = std::fread(begin.data(), 1, begin.size(), file) == begin.size();
  std::fclose(file);
  return whole && std::string_view(begin.data(), begin.size()) == "LASF";
}

FileContents contentsOfLas(const std::filesystem::path& path) {
  const LasReader reader(path);
  const LasHead& head = reader.head();
  FileElement vertex{.name = "vertex", .count = head.header.points, .properties = {{"x"}, {"y"}, {"z"}}};
  if (head.format.colorAt > 0)
    for (const char* name : {"red", "green", "blue"}) vertex.properties.push_back({name});
  for (const LasField& field : head.format.fields) vertex.properties.push_back({field.name});
  for (const LasExtraField& extra : head.extra) vertex.properties.push_back({extra.field.name});
  return {.elements = {std::move(vertex)}, .comments = head.comments};
}

StoredCloud readLas(const std::filesystem::path& path, Log* log, const CloudReadOptions& options) {
  if (options.normalsFromFaces && log) log->say("{}: has no faces to take normals from", path.filename().string());
  StoredCloud stored;
  LasReader reader(path);
  stored.cloud = reader.read(log, stored.lost);
  return stored;
}

}  // namespace

CloudFormat lasFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".las"};
  return {.name = "LAS",
          .endings = kEndings,
          .holds = holdsLas,
          .contents = contentsOfLas,
          .read = readLas,
          .write = writeLas,
          .lacks = lacksOfLas};
}

}  // namespace palpate
