#include "engine/io/mesh_format.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "engine/cloud/length_unit.hpp"
#include "engine/core/error.hpp"
#include "engine/io/cloud_arrays.hpp"
#include "engine/io/mesh_import.hpp"
#include "engine/io/mesh_writer.hpp"
#include "engine/io/ply_faces.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr std::uint64_t kSeed = 1;
constexpr std::array<std::string_view, 1> kObj{".obj"}, kStl{".stl"}, kOff{".off"};
constexpr std::array<std::string_view, 2> kGltf{".gltf", ".glb"};

std::string madeFrom(const TriangleSoup& soup) { return fmt::format("{} triangles", soup.triangles.size()); }

void needTriangles(const std::filesystem::path& file, const ImportedMesh& mesh) {
  if (mesh.soup.triangles.empty()) throw FileError(file, "has no triangles; points are read from other formats");
}

using Import = ImportedMesh (*)(const std::filesystem::path& file);

template <Import import>
FileContents contentsOfMesh(const std::filesystem::path& file) {
  const ImportedMesh mesh = import(file);
  needTriangles(file, mesh);
  FileElement vertex{.name = "vertex", .count = kUsualSamples, .properties = {}};
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) vertex.properties.push_back({name});
  if (!mesh.soup.colors.empty())
    for (const char* name : {"red", "green", "blue"}) vertex.properties.push_back({name});
  return {.elements = {std::move(vertex)}, .comments = {}, .madeFrom = madeFrom(mesh.soup)};
}

/// Whether single precision holds a number: to the last bit, or to the last digit that somebody wrote of it.
bool isNarrow(double number) {
  const auto narrow = static_cast<float>(number);
  if (static_cast<double>(narrow) == number) return true;
  std::array<char, 32> text;
  const auto end = fmt::format_to_n(text.data(), text.size(), "{}", narrow).out;
  return textNumber<double>({text.data(), static_cast<std::size_t>(end - text.data())}) == number;
}

PointCloud cornersOf(const std::filesystem::path& file, const TriangleSoup& soup, Log* log) {
  std::vector<Vec3> narrow;
  bool exact = true;
  for (const DVec3& corner : soup.corners) {
    constexpr double kFarthest = 1e30;
    if (!(std::abs(corner.x) < kFarthest && std::abs(corner.y) < kFarthest && std::abs(corner.z) < kFarthest))
      throw FileError(file,
                      fmt::format("a corner of its triangles is at ({}, {}, {}); expected finite numbers below 1e30",
                                  corner.x, corner.y, corner.z));
    narrow.emplace_back(corner);
    exact = exact && isNarrow(corner.x) && isNarrow(corner.y) && isNarrow(corner.z);
  }
  const auto rows = [](const auto& values, ScalarType type) {
    return values.empty() ? NumberRows{}
                          : NumberRows{reinterpret_cast<const std::byte*>(values.data()), type, sizeof(values[0])};
  };
  return cloudOf({.count = soup.corners.size(),
                  .positions = exact ? rows(narrow, ScalarType::f32) : rows(soup.corners, ScalarType::f64),
                  .normals = rows(soup.normals, ScalarType::f32),
                  .colors = rows(soup.colors, ScalarType::u8)},
                 log);
}

template <Import import>
StoredCloud readMesh(const std::filesystem::path& file, Log* log, const CloudReadOptions& options) {
  ImportedMesh mesh = import(file);
  needTriangles(file, mesh);
  if (options.normalsFromFaces) mesh.soup.normals.clear();
  if (options.asTriangles) {
    PointCloud corners = cornersOf(file, mesh.soup, log);
    if (options.normalsFromFaces) {
      PlyFaces faces(corners.size());
      for (const auto& [a, b, c] : mesh.soup.triangles) faces.add(std::array<std::int64_t, 3>{a, b, c}, false);
      faces.applyTo(corners, file, log);
    }
    return {.cloud = std::move(corners), .triangles = std::move(mesh.soup.triangles), .lost = std::move(mesh.lost)};
  }
  const std::size_t count = options.samples > 0 ? options.samples : kUsualSamples;
  SampledSoup sampled = sampleSoup(mesh.soup, count, kSeed);
  if (sampled.cloud.empty()) throw FileError(file, fmt::format("none of its {} has an area", madeFrom(mesh.soup)));
  const std::string name = file.filename().string();
  if (log) log->say("{}: {} points, spread evenly over {}", name, sampled.cloud.size(), madeFrom(mesh.soup));
  StoredCloud stored{.cloud = std::move(sampled.cloud), .triangles = {}, .lost = std::move(mesh.lost)};
  stored.lost.insert(stored.lost.begin(), madeFrom(mesh.soup) + ", of which the points are samples");
  if (sampled.flat > 0) stored.lost.push_back(fmt::format("{} triangles without an area", sampled.flat));
  return stored;
}

StoredCloud readGltf(const std::filesystem::path& file, Log* log, const CloudReadOptions& options) {
  StoredCloud stored = readMesh<importGltf>(file, log, options);
  stored.cloud.storedAs.comments.emplace_back("comment up: y");  // as the format says, and
  sayUnit(stored.cloud.storedAs.comments, LengthUnit::m);
  return stored;
}

}  // namespace

CloudFormat objFormat() {
  return {.name = "OBJ",
          .endings = kObj,
          .contents = contentsOfMesh<importObj>,
          .read = readMesh<importObj>,
          .write = writeObj,
          .lacks = lacksOfObj,
          .ofTriangles = true};
}

CloudFormat stlFormat() {
  return {.name = "STL",
          .endings = kStl,
          .contents = contentsOfMesh<importStl>,
          .read = readMesh<importStl>,
          .write = writeStl,
          .lacks = lacksOfStl,
          .ofTriangles = true};
}

CloudFormat offFormat() {
  return {.name = "OFF",
          .endings = kOff,
          .contents = contentsOfMesh<importOff>,
          .read = readMesh<importOff>,
          .write = writeOff,
          .lacks = lacksOfOff,
          .ofTriangles = true};
}

CloudFormat gltfFormat() {
  return {
      .name = "glTF", .endings = kGltf, .contents = contentsOfMesh<importGltf>, .read = readGltf, .ofTriangles = true};
}

}  // namespace palpate
