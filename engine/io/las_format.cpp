#include "engine/io/known_formats.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstring>

#include "engine/core/clock.hpp"
#include "engine/core/system_file.hpp"
#include "engine/io/las_reader.hpp"
#include "engine/io/las_writer.hpp"

namespace palpate {

namespace {

constexpr std::string_view kFamily = "LAS";

enum class LasKind { none, las, laz, copc };

/// Determined by the first bytes of a file.
LasKind kindOf(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return LasKind::none;
  std::FILE* file = openFile(path, "rb");
  if (!file) return LasKind::none;
  std::array<std::byte, kCopcHead> bytes{};
  const std::span begin(bytes.data(), std::fread(bytes.data(), 1, bytes.size(), file));
  std::fclose(file);
  constexpr std::size_t kFormatAt = 104;
  if (begin.size() < 4 || std::memcmp(begin.data(), "LASF", 4) != 0) return LasKind::none;
  if (begin.size() <= kFormatAt || !(static_cast<unsigned>(begin[kFormatAt]) & kLazBit)) return LasKind::las;
  return isCopc(begin) ? LasKind::copc : LasKind::laz;
}

bool holdsLas(const std::filesystem::path& path) { return kindOf(path) == LasKind::las; }
bool holdsLaz(const std::filesystem::path& path) { return kindOf(path) == LasKind::laz; }
bool holdsCopc(const std::filesystem::path& path) { return kindOf(path) == LasKind::copc; }

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
  const Stopwatch opening;
  LasReader reader(path);
  if (options.stages) options.stages->open_s = opening.elapsed_s();
  stored.cloud = reader.read(log, stored.lost, options);
  if (reader.head().format.hasWaves && reader.head().header.format >= 6 && !holdsLas(path))
    stored.lost.emplace_back("where the waves of points are, which is not unpacked");
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
          .lacks = lacksOfLas,
          .attributes = attributesOfLas,
          .hasComments = true,
          .family = kFamily};
}

CloudFormat lazFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".laz"};
  return {.name = "LAZ",
          .endings = kEndings,
          .holds = holdsLaz,
          .contents = contentsOfLas,
          .read = readLas,
          .write = writeLaz,
          .lacks = lacksOfLas,
          .attributes = attributesOfLas,
          .hasComments = true,
          .family = kFamily};
}

CloudFormat copcFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".copc.laz"};
  return {.name = "COPC",
          .endings = kEndings,
          .holds = holdsCopc,
          .contents = contentsOfLas,
          .read = readLas,
          .family = kFamily};
}

}  // namespace palpate
