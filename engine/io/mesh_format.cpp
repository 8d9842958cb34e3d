#include "engine/io/known_formats.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "engine/cloud/length_unit.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/cloud_arrays.hpp"
#include "engine/io/cloud_format.hpp"
#include "engine/io/ends_after.hpp"
#include "engine/io/mesh_import.hpp"
#include "engine/io/ply_faces.hpp"
#include "engine/io/row_output.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

/// Writes triangle meshes: OBJ (Wavefront), STL (3D Systems) and OFF (Geomview).
/// All functions write the triangles given in the options, whose corners are the points of the cloud. The file appears
/// under its name only when it is complete. They throw FileError, also without triangles.

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

/// Writes positions, colours and normals as text.
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

/// Writes positions in single precision and normals of triangles, binary unless ASCII is requested.
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

/// Writes positions as text.
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

constexpr std::uint64_t kSeed = 1;
constexpr std::array<std::string_view, 1> kObj{".obj"}, kStl{".stl"}, kOff{".off"};
constexpr std::array<std::string_view, 2> kGltf{".gltf", ".glb"};

std::string madeFrom(const TriangleSoup& soup) { return counted(soup.triangles.size(), "triangle"); }

using Import = ImportedMesh (*)(const std::filesystem::path& file);

/// Leaves out corners that are not finite, with their triangles, and counts them.
ImportedMesh importedBy(Import import, const std::filesystem::path& file) {
  ImportedMesh mesh = import(file);
  const std::size_t before = mesh.soup.triangles.size();
  const BadCorners bad = leaveOutBadCorners(mesh.soup);
  if (mesh.soup.corners.empty() || (before > 0 && mesh.soup.triangles.empty()))
    throw FileError(file, before + bad.corners > 0 ? "none of its corners has a finite position"
                                                   : "has neither triangles nor points");
  if (bad.triangles > 0)
    mesh.lost.push_back(fmt::format("{} with a corner that is not finite", counted(bad.triangles, "triangle")));
  else if (bad.corners > 0)
    mesh.lost.push_back(fmt::format("{} without a finite position below 1e30", counted(bad.corners, "point")));
  return mesh;
}

template <Import import>
FileContents contentsOfMesh(const std::filesystem::path& file) {
  const ImportedMesh mesh = importedBy(import, file);
  const bool points = mesh.soup.triangles.empty();
  FileElement vertex{.name = "vertex",
                     .count = points ? mesh.soup.corners.size() : kUsualSamples,
                     .properties = {{"x"}, {"y"}, {"z"}}};
  if (!points || !mesh.soup.normals.empty())
    for (const char* name : {"nx", "ny", "nz"}) vertex.properties.push_back({name});
  if (!mesh.soup.colors.empty() || !mesh.soup.textures.empty())
    for (const char* name : {"red", "green", "blue"}) vertex.properties.push_back({name});
  return {.elements = {std::move(vertex)}, .comments = {}, .madeFrom = points ? "" : madeFrom(mesh.soup)};
}

/// Whether single precision holds a number: exactly, or to the last decimal digit written.
bool isNarrow(double number) {
  const auto narrow = static_cast<float>(number);
  if (static_cast<double>(narrow) == number) return true;
  std::array<char, 32> text;
  const auto end = fmt::format_to_n(text.data(), text.size(), "{}", narrow).out;
  return textNumber<double>({text.data(), static_cast<std::size_t>(end - text.data())}) == number;
}

PointCloud cornersOf(const TriangleSoup& soup, Log* log) {
  std::vector<Vec3> narrow, normals = soup.normals;
  for (Vec3& normal : normals)  // a normal that is not finite counts as missing
    if (!std::isfinite(glm::dot(normal, normal))) normal = Vec3(0);
  bool exact = true;
  for (const DVec3& corner : soup.corners) {
    narrow.emplace_back(corner);
    exact = exact && isNarrow(corner.x) && isNarrow(corner.y) && isNarrow(corner.z);
  }
  const auto rows = [](const auto& values, ScalarType type) {
    return values.empty() ? NumberRows{}
                          : NumberRows{reinterpret_cast<const std::byte*>(values.data()), type, sizeof(values[0])};
  };
  return cloudOf({.count = soup.corners.size(),
                  .positions = exact ? rows(narrow, ScalarType::f32) : rows(soup.corners, ScalarType::f64),
                  .normals = rows(normals, ScalarType::f32),
                  .colors = rows(soup.colors, ScalarType::u8)},
                 log);
}

template <Import import>
StoredCloud readMesh(const std::filesystem::path& file, Log* log, const CloudReadOptions& options) {
  ImportedMesh mesh = importedBy(import, file);
  const std::string name = file.filename().string();
  if (log && mesh.openLine > 0) sayOpenLine(name, mesh.openLine, *log);
  if (mesh.soup.triangles.empty()) {
    if (log) log->say("{}: has no triangles; its {} corners are the points", name, mesh.soup.corners.size());
    return {.cloud = cornersOf(mesh.soup, log), .triangles = {}, .lost = std::move(mesh.lost)};
  }
  if (options.normalsFromFaces) mesh.soup.normals.clear();
  if (options.asTriangles) {
    const std::size_t textures = mesh.soup.textures.size();
    const std::vector<std::string> unread = colorCorners(mesh.soup);
    if (textures > unread.size())
      mesh.lost.push_back(
          fmt::format("the colours of {} between the corners", counted(textures - unread.size(), "texture")));
    mesh.lost.insert(mesh.lost.end(), unread.begin(), unread.end());
    PointCloud corners = cornersOf(mesh.soup, log);
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
  if (log) log->say("{}: {}, spread evenly over {}", name, counted(sampled.cloud.size(), "point"), madeFrom(mesh.soup));
  StoredCloud stored{.cloud = std::move(sampled.cloud), .triangles = {}, .lost = std::move(mesh.lost)};
  stored.lost.insert(stored.lost.begin(), madeFrom(mesh.soup) + ", of which the points are samples");
  for (std::string& what : sampled.lost) stored.lost.push_back(std::move(what));
  if (sampled.flat > 0) stored.lost.push_back(fmt::format("{} without an area", counted(sampled.flat, "triangle")));
  return stored;
}

StoredCloud readGltf(const std::filesystem::path& file, Log* log, const CloudReadOptions& options) {
  StoredCloud stored = readMesh<importGltf>(file, log, options);
  stored.cloud.storedAs.comments.emplace_back("comment up: y");  // up axis and unit as defined by the format
  sayUnit(stored.cloud.storedAs.comments, LengthUnit::m);
  return stored;
}

bool beginsAsObj(const FileStart& start) {
  if (!start.isText()) return false;
  constexpr std::array<std::string_view, 9> kStatements{"v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl"};
  const auto lines = start.lines(20);
  const auto isStatement = [&](const std::vector<std::string>& line) {
    return std::ranges::find(kStatements, line[0]) != kStatements.end();
  };
  const auto isVertex = [](const std::vector<std::string>& line) {
    return line[0] == "v" && line.size() >= 4 && isNumberWord(line[1]);
  };
  return std::ranges::all_of(lines, isStatement) && std::ranges::any_of(lines, isVertex);
}

bool beginsAsStl(const FileStart& start) {
  constexpr std::size_t kHead = 84, kTriangle = 50;
  if (start.startsWith("solid") && start.isText()) return start.bytes.find("facet") != std::string::npos;
  if (start.bytes.size() < kHead) return false;
  std::uint32_t count = 0;
  for (unsigned k = 0; k < 4; ++k) count |= std::uint32_t{static_cast<unsigned char>(start.bytes[80 + k])} << (8 * k);
  return count > 0 && start.size == kHead + std::uint64_t{kTriangle} * count;
}

bool beginsAsOff(const FileStart& start) {
  if (!start.isText()) return false;
  const auto lines = start.lines(2);
  if (lines.empty()) return false;
  const std::string& word = lines[0][0];
  const std::size_t name = word.find("OFF");
  if (name == std::string::npos || word.find_first_not_of("CNST4n") < name) return false;
  return word.size() == name + 3 || isNumberWord(std::string_view(word).substr(name + 3));
}

bool beginsAsGltf(const FileStart& start) {
  if (start.startsWith("glTF")) return true;
  const std::size_t first = start.bytes.find_first_not_of(" \t\r\n");
  return first != std::string::npos && start.bytes[first] == '{' && start.isText() &&
         start.bytes.find("\"asset\"") != std::string::npos;
}

std::vector<const Attribute*> noAttributes(const PointCloud&) { return {}; }

}  // namespace

CloudFormat objFormat() {
  return {.name = "OBJ",
          .endings = kObj,
          .begins = beginsAsObj,
          .contents = contentsOfMesh<importObj>,
          .read = readMesh<importObj>,
          .write = writeObj,
          .lacks = lacksOfObj,
          .attributes = noAttributes,
          .ofTriangles = true};
}

CloudFormat stlFormat() {
  return {.name = "STL",
          .endings = kStl,
          .begins = beginsAsStl,
          .contents = contentsOfMesh<importStl>,
          .read = readMesh<importStl>,
          .write = writeStl,
          .lacks = lacksOfStl,
          .attributes = noAttributes,
          .keepsNormals = false,
          .keepsColors = false,
          .ofTriangles = true};
}

CloudFormat offFormat() {
  return {.name = "OFF",
          .endings = kOff,
          .begins = beginsAsOff,
          .contents = contentsOfMesh<importOff>,
          .read = readMesh<importOff>,
          .write = writeOff,
          .lacks = lacksOfOff,
          .attributes = noAttributes,
          .keepsNormals = false,
          .keepsColors = false,
          .ofTriangles = true};
}

CloudFormat gltfFormat() {
  return {.name = "glTF",
          .endings = kGltf,
          .begins = beginsAsGltf,
          .contents = contentsOfMesh<importGltf>,
          .read = readGltf,
          .ofTriangles = true};
}

}  // namespace palpate
