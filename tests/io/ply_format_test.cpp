// PLY: losses of reading, clouds written and read unchanged, and files of other programs.
#include "engine/io/known_formats.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"
#include "engine/io/ply_reader.hpp"
#include "engine/io/ply_writer.hpp"
#include "tests/io/ply_bytes.hpp"
#include "tests/shared_files.hpp"

namespace palpate::test::ply_format_test {

namespace {

StoredCloud stored(const std::string& elements, const std::string& rows) {
  const TemporaryFile file("ply\nformat ascii 1.0\n" + elements + "end_header\n" + rows);
  return plyFormat().read(file.path(), nullptr, {});
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "element face 2\nproperty list uchar int vertex_indices\n";

bool names(const std::vector<std::string>& lost, std::string_view what) {
  return std::ranges::any_of(lost, [&](const std::string& one) { return contains(one, what); });
}

/// Reads `text`, writes it in both encodings, reads each and writes it again: the second file must equal the first.
void checkRoundTrip(const std::string& text) {
  const TemporaryFile source(text), binary, ascii, again;
  const PointCloud cloud = readPly(source.path());
  writePly(binary.path(), cloud);
  writePly(ascii.path(), cloud, {.ascii = true});
  for (const TemporaryFile* written : {&binary, &ascii}) {
    const PointCloud back = readPly(written->path());
    CHECK(back.origin == cloud.origin);
    CHECK(back.positions == cloud.positions);
    CHECK(back.exactPositions == cloud.exactPositions);
    CHECK(back.normals == cloud.normals);
    CHECK(back.colors == cloud.colors);
    CHECK(back.storedAs.comments == cloud.storedAs.comments);
    REQUIRE(back.extra.size() == cloud.extra.size());
    for (std::size_t k = 0; k < cloud.extra.size(); ++k) {
      CHECK(back.extra[k].name == cloud.extra[k].name);
      CHECK(back.extra[k].type == cloud.extra[k].type);
      CHECK(back.extra[k].data == cloud.extra[k].data);
    }
    writePly(again.path(), back);
    CHECK(again.content() == binary.content());
  }
}

std::string cloudOfTypes(PlyFormat format, ScalarType position, ScalarType normal, ScalarType color, ScalarType extra) {
  std::string header = magic(format) + "comment keep me\nobj_info and me\nelement vertex 50\n";
  for (const char* name : {"x", "y", "z"}) header += fmt::format("property {} {}\n", plyName(position), name);
  for (const char* name : {"nx", "ny", "nz"}) header += fmt::format("property {} {}\n", plyName(normal), name);
  for (const char* name : {"red", "green", "blue", "alpha"})
    header += fmt::format("property {} {}\n", plyName(color), name);
  header += fmt::format("property {} scalar_Something\nend_header\n", plyName(extra));
  BodyWriter body(format);
  for (int i = 0; i < 50; ++i) {
    for (int k = 0; k < 3; ++k) body.put(position, 10 * std::sin(i + k) + 20);
    for (int k = 0; k < 3; ++k) body.put(normal, isFloating(normal) ? std::cos(i + 2 * k) : 100 * std::cos(i + 2 * k));
    for (int k = 0; k < 4; ++k) body.put(color, isFloating(color) ? (5 * i + k) / 255.0 : (5 * i + k) % 128);
    body.put(extra, i / 3.0).endRow();
  }
  return header + body.text();
}

void checkNear(const DVec3& found, const nlohmann::json& expected) {
  for (int k = 0; k < 3; ++k) {
    const double value = expected[static_cast<std::size_t>(k)].get<double>();
    CHECK(std::abs(found[k] - value) <= 1.2e-7 * std::abs(value) + 1e-12);
  }
}

void checkCloud(const std::filesystem::path& path, const nlohmann::json& truth) {
  const PlyInfo info = readPlyInfo(path);
  CHECK(plyName(info.format) == truth["format"].get<std::string>());
  REQUIRE(info.elements.size() == truth["elements"].size());
  for (std::size_t k = 0; k < info.elements.size(); ++k) {
    CHECK(info.elements[k].name == truth["elements"][k][0].get<std::string>());
    CHECK(info.elements[k].count == truth["elements"][k][1].get<std::uint64_t>());
  }
  const PointCloud cloud = readPly(path);
  REQUIRE(cloud.size() == truth["vertices"].get<std::size_t>());
  const Bounds box = boundsOf(cloud);
  checkNear(cloud.origin + box.min, truth["bbox_min"]);
  checkNear(cloud.origin + box.max, truth["bbox_max"]);
  checkNear(cloud.fileCoordinates(0), truth["first"]);
  checkNear(cloud.fileCoordinates(cloud.size() - 1), truth["last"]);
  CHECK(cloud.hasNormals() == truth["normals"].get<bool>());
  CHECK(cloud.hasColors() == !truth["colours"].empty());
  CHECK(cloud.storedAs.alpha == (truth["colours"].size() == 4));
  if (!cloud.hasColors()) return;
  const double scale = isFloating(cloud.storedAs.color) ? 255.0 : 1.0;
  for (std::size_t k = 0; k < truth["colours"].size(); ++k)
    CHECK(cloud.colors[0][k] == std::lround(scale * truth["first_colour"][k].get<double>()));
}

}  // namespace

TEST_CASE("a cloud written as it was read loses nothing") {
  const StoredCloud cloud =
      stored("element vertex 3\n" + kXyz + "property uchar red\nproperty uchar green\nproperty uchar blue\n" + kFaces,
             "0 0 0 1 2 3\n1 0 0 4 5 6\n0 1 0 7 8 9\n3 0 1 2\n3 2 1 0\n");
  CHECK(cloud.lost.empty());
  CHECK(cloud.triangles.size() == 2);
}

TEST_CASE("all properties lost by reading PLY are listed") {
  const StoredCloud cloud = stored(
      "element vertex 4\n" + kXyz + "property list uchar int links\nproperty ushort red\nproperty ushort green\n" +
          "property ushort blue\n" + kFaces + "property uchar material\nelement edge 1\nproperty int a\n" +
          "element nothing 0\nproperty int a\n",
      "0 0 0 0 1 2 3000\n1 0 0 0 4 5 6\n0 1 0 0 7 8 9\n1 1 0 1 5 7 8 9\n3 0 1 2 7\n4 0 1 3 2 7\n5\n");
  CHECK(cloud.lost.size() == 5);
  CHECK(names(cloud.lost, "'links' of vertex"));
  CHECK(names(cloud.lost, "'material' of face"));
  CHECK(names(cloud.lost, "1 edge"));
  CHECK(names(cloud.lost, "2 faces, which become 3 triangles"));
  CHECK(names(cloud.lost, "8 bits"));
}

TEST_CASE("reading points alone from PLY gives no triangles, and damaged faces cause no error") {
  const std::string points = "element vertex 3\n" + kXyz, rows = "0 0 0\n1 0 0\n0 1 0\n";
  const TemporaryFile file("ply\nformat ascii 1.0\n" + points + kFaces + "end_header\n" + rows + "3 0 1 2\n3 0 1 9\n");
  CHECK_THROWS_AS(plyFormat().read(file.path(), nullptr, {}), FileError);
  const StoredCloud cloud = plyFormat().read(file.path(), nullptr, {.pointsOnly = true});
  CHECK(cloud.cloud.size() == 3);
  CHECK(cloud.triangles.empty());
  CHECK(cloud.lost.empty());
}

TEST_CASE("the contents of a PLY file are read from its header alone") {
  const TemporaryFile file("ply\nformat ascii 1.0\ncomment by hand\nelement vertex 7\n" + kXyz + kFaces +
                           "end_header\n");
  const FileContents contents = plyFormat().contents(file.path());
  REQUIRE(contents.elements.size() == 2);
  CHECK(contents.elements[0].name == "vertex");
  CHECK(contents.elements[0].count == 7);
  REQUIRE(contents.elements[0].properties.size() == 3);
  CHECK(contents.elements[0].properties[2].name == "z");
  CHECK_FALSE(contents.elements[0].properties[2].isList);
  CHECK(contents.elements[1].properties.at(0).isList);
  CHECK(contents.comments == std::vector<std::string>{"comment by hand"});
}

TEST_CASE("PLY properties replaced by later normals are listed as lost") {
  StoredCloud cloud = stored("element vertex 1\n" + kXyz + "property float nx\nproperty float heat\n", "0 0 0 5 6\n");
  const CloudFormat ply = plyFormat();
  CHECK(ply.lacks(cloud.cloud).empty());
  cloud.cloud.normals = {Vec3(0, 0, 1)};
  CHECK(ply.lacks(cloud.cloud).size() == 1);
  CHECK(names(ply.lacks(cloud.cloud), "'nx' of vertex"));
}

TEST_CASE("PLY clouds of every type and encoding are written and read unchanged") {
  using enum ScalarType;
  for (const PlyFormat format : kAllFormats) {
    for (const ScalarType type : {i8, u8, i16, u16, i32, u32, f32, f64}) {
      CAPTURE(plyName(format));
      CAPTURE(plyName(type));
      checkRoundTrip(cloudOfTypes(format, type, f32, u8, f32));
      checkRoundTrip(cloudOfTypes(format, f32, f32, type, type));
    }
    checkRoundTrip(cloudOfTypes(format, f64, f64, f64, f64));
    checkRoundTrip(cloudOfTypes(format, f32, i8, f32, i16));
  }
}

TEST_CASE("a plain binary PLY file is written back byte by byte") {
  std::string text =
      magic(PlyFormat::binaryLittleEndian) +
      "comment hello\nelement vertex 1000\nproperty double x\nproperty double y\nproperty double z\nproperty float nx\n"
      "property float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property ushort ring\nend_header\n";
  BodyWriter body(PlyFormat::binaryLittleEndian);
  using enum ScalarType;
  for (int i = 0; i < 1000; ++i) {
    body.put(f64, 1e6 + 0.1 * i).put(f64, -3e6 / 7 + i).put(f64, i / 3.0);
    body.put(f32, std::sin(i)).put(f32, std::cos(i)).put(f32, 0).put(u8, i % 256).put(u8, 1).put(u8, 2).put(u16, i);
  }
  const TemporaryFile file(text + body.text()), out;
  writePly(out.path(), readPly(file.path()));
  CHECK(out.content() == file.content());
}

TEST_CASE("a moved point is written at its new position, the others unchanged") {
  const TemporaryFile file(magic(PlyFormat::ascii) +
                           "element vertex 2\nproperty double x\nproperty double y\nproperty double z\nend_header\n"
                           "1000000.1 0.1 0.2\n1000001.1 0.1 0.2\n"),
      out;
  PointCloud cloud = readPly(file.path());
  cloud.positions[1] += Vec3(0, 0, 0.5f);
  writePly(out.path(), cloud, {.ascii = true});
  CHECK(contains(out.content(), "\n1000000.1 0.1 0.2\n"));
  const PointCloud back = readPly(out.path());
  CHECK(glm::distance(back.fileCoordinates(1), DVec3(1000001.1, 0.1, 0.7)) < 1e-6);
}

TEST_CASE("normals that are added replace a lone nx of the input") {
  const TemporaryFile file(magic(PlyFormat::ascii) +
                           "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float "
                           "nx\nend_header\n0 0 0 3\n"),
      out;
  PointCloud cloud = readPly(file.path());
  CHECK(cloud.extra.size() == 1);
  cloud.normals = {Vec3(0, 0, 1)};
  writePly(out.path(), cloud);
  CHECK(readPly(out.path()).normals.at(0) == Vec3(0, 0, 1));
}

TEST_CASE("an empty cloud can be written to PLY and read") {
  const TemporaryFile out;
  for (const bool ascii : {false, true}) {
    writePly(out.path(), PointCloud{}, {ascii});
    CHECK(readPly(out.path()).empty());
  }
}

TEST_CASE("an output path that cannot be written gives an error with its name") {
  CHECK(contains(errorOf([] { writePly("/nowhere/at/all.ply", PointCloud{}); }),
                 "/nowhere/at/all.ply: cannot be written"));
}

TEST_CASE("PLY files of other programs are read as their manifest says") {
  const std::filesystem::path list = sharedFile("wild/manifest.json");
  if (list.empty()) return;
  std::ifstream file(list);
  const nlohmann::json manifest = nlohmann::json::parse(file);
  for (const auto& [name, truth] : manifest.items()) {
    CAPTURE(name);
    const std::string expect = truth["expect"];
    const std::filesystem::path path = list.parent_path() / name;
    if (expect == "ok") {
      CHECK_NOTHROW(checkCloud(path, truth));
    } else {
      const std::string message = errorOf([&] { readPly(path); });
      const bool namesPlace = message.starts_with(path.string() + ":");
      CHECK((namesPlace || (expect == "either" && message.empty())));
    }
  }
}

}  // namespace palpate::test::ply_format_test
