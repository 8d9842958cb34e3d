#include <doctest/doctest.h>

#include "engine/core/error.hpp"
#include "engine/io/ply_reader.hpp"
#include "engine/io/ply_writer.hpp"
#include "tests/io/ply_bytes.hpp"

namespace palpate::test::ply_round_trip_test {
namespace {

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

}  // namespace

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

}  // namespace palpate::test::ply_round_trip_test
