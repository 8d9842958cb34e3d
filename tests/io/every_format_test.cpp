// The same rules for every format: its content identifies a file, rows without a position are left out and counted, the
// whole column determines the scale of colours, and a truncated file is refused.
#include <doctest/doctest.h>

#include <fmt/format.h>
#include <cmath>
#include <set>

#include "engine/io/e57_scans.hpp"
#include "tests/error_of.hpp"
#include "tests/io/e57_bytes.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/io/fuzz_specimens.hpp"
#include "tests/io/gltf_bytes.hpp"
#include "tests/io/npy_bytes.hpp"
#include "tests/io/ply_bytes.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::test::every_format_test {

namespace {

std::string kindOf(const std::string& name, const std::string& bytes) {
  const ScratchFolder folder;
  std::ofstream(folder / name, std::ios::binary) << bytes;
  const CloudFormat* format = cloudFormats().recognised(folder / name);
  return format ? std::string(format->name) : "unknown";
}

const std::string kPly =
    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 "
    "3\n";

void checkTwoPoints(const StoredCloud& stored, const std::string& count) {
  REQUIRE(stored.cloud.size() == 2);
  CHECK(stored.cloud.fileCoordinates(0) == DVec3(1, 2, 3));
  CHECK(stored.cloud.fileCoordinates(1) == DVec3(4, 5, 6));
  REQUIRE_FALSE(stored.lost.empty());
  CHECK(stored.lost[0] == count);
}

/// The sheet as PLY text with colours times `scale`, of type `type`.
std::string plySheet(const std::string& type, double scale, int dark = -1) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex 20\nproperty float x\nproperty float y\nproperty float z\nproperty {0} "
      "red\nproperty {0} green\nproperty {0} blue\nend_header\n",
      type);
  for (int k = 0; k < Sheet::kPoints; ++k) {
    const auto [r, g, b] = Sheet::color(k);
    const double factor = k == dark ? 0.5 / 255 : 1;
    const DVec3 p = Sheet::place(k);
    text +=
        fmt::format("{} {} {} {} {} {}\n", p.x, p.y, p.z, r * scale * factor, g * scale * factor, b * scale * factor);
  }
  return text;
}

std::string lines(double scale, const std::string& before = "", const std::string& vertex = "") {
  std::string text = before;
  for (int k = 0; k < Sheet::kPoints; ++k) {
    const auto [r, g, b] = Sheet::color(k);
    const DVec3 p = Sheet::place(k);
    text += fmt::format("{}{} {} {} {} {} {}\n", vertex, p.x, p.y, p.z, r * scale, g * scale, b * scale);
  }
  return text;
}

bool has(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

struct Heard final : LogListener {
  void said(std::string_view line) override { text += std::string(line) + "\n"; }
  void progressed(std::string_view, double) override {}
  std::string text;
};

/// What is said of half of a file: the error, or what the log got.
std::string saidOfHalf(const Specimen& specimen, bool& isRefused) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / specimen.name;
  const std::string whole = specimen.dressed ? specimen.dressed(specimen.text) : specimen.text;
  std::ofstream(file, std::ios::binary) << whole.substr(0, whole.size() / 2);
  Heard heard;
  Log log(true);
  log.listen(&heard);
  const std::string error = errorOf([&] { readCloud(file, &log, {.samples = 40}); });
  isRefused = !error.empty();
  if (isRefused) CHECK(error.starts_with(file.string()));
  return isRefused ? error : heard.text;
}

}  // namespace

TEST_CASE("the content of a file determines its format, whatever its ending") {
  CHECK(kindOf("a.xyz", kPly) == "PLY");
  CHECK(kindOf("a", kPly) == "PLY");
  CHECK(kindOf("a.ply", "1 2 3\n4 5 6\n") == "XYZ");
  CHECK(kindOf("a.dat", "x,y,z\n1,2,3\n") == "XYZ");
  CHECK(kindOf("a.csv", "x,y,z\n1,2,3\n") == "CSV");
  CHECK(kindOf("a.txt", "v 1 2 3\nv 4 5 6\nf 1 2 1\n") == "OBJ");
  CHECK(kindOf("a.stl", "OFF\n3 1 0\n0 0 0\n") == "OFF");
  CHECK(kindOf("a.obj", "solid a\nfacet normal 0 0 1\n") == "STL");
  CHECK(kindOf("a.las", "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\n") == "PCD");
  CHECK(kindOf("a.xyz", "2\n1 2 3 4\n1 2 3 4\n") == "PTS");
  CHECK(kindOf("a.pts", "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 1 1 1\n") == "PTX");
  CHECK(kindOf("a.bin", "ASTM-E57") == "E57");
  CHECK(kindOf("a.obj", gltfTriangle(true)) == "glTF");
  CHECK(kindOf("a.bin", gltfTriangle(false)) == "glTF");
  CHECK(kindOf("a.gz", "\x1f\x8b\x08") == "SPZ");
  CHECK(kindOf("a.dat", "Dear reader\n") == "unknown");
}

TEST_CASE("a file of another kind is refused with its kind and advice") {
  const std::string png = "\x89PNG\r\n\x1a\n";
  for (const char* name : {"a.png", "a.ply", "a.xyzzy"}) {
    CAPTURE(name);
    refuses(name, png + std::string(40, '\0'), ": is an image (PNG), not a 3D file");
  }
  refuses("a.jpg", "\xff\xd8\xff\xe0", ": is an image (JPEG), not a 3D file");
  refuses("a.ply", "%PDF-1.7\n", ": is a document (PDF), not a 3D file");
  refuses("a.zip", "PK\3\4" + std::string(26, '\0') + "a.txt", ": is an archive (ZIP); unpack it first");
  refuses("a.sog", "PK\3\4" + std::string(26, '\0') + "meta.json", "...is SOG...");
  refuses("a.ksplat", std::string(64, '\1'), "...export it as an uncompressed PLY...");
  refuses("a.drc", "DRACO\2\2", "...Draco...");
  refuses("a.fbx", "Kaydara FBX Binary", "...is FBX...");
  refuses("a.ply", "<!DOCTYPE html><html>", "...web page...");
  refuses("a.ply", std::string("\x7f") + "ELF", ": is a program, not a 3D file");
  refuses("a.mp4", std::string("\0\0\0\x18", 4) + "ftypmp42", ": is a video, not a 3D file");
  refuses("a.las", "", ": is empty; it contains no points");
  refuses("a.ply.gz", "\x1f\x8b\x08" + std::string(40, '\0'), "...byte...");
  refuses("a.dat", "Dear reader\n", ": is text, not a 3D file that can be read (it begins with 'Dear...");
  refuses("a.dat", std::string("\1\2\3\0\4", 5), ": is of an unknown kind...");
  for (const char* junk : {"Dear reader\n", "\1\2\3\xff?V???\n"}) refuses("a.ply", junk, ": is not a PLY file");
  CHECK_THROWS_WITH_AS(readCloud("-"), doctest::Contains("standard input"), FileError);
}

TEST_CASE("rows without a finite position are left out and counted: PLY, PCD, text, NPY, OBJ, OFF") {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  const std::string rows = "1 2 3\nnan nan nan\n1 inf 0\n4 5 6\n-nan 0 -inf\n";
  checkTwoPoints(readingFile("a.ply", ply + rows), "3 points without a finite position below 1e30");
  const std::string pcd =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 5\nHEIGHT 1\nPOINTS 5\nDATA ascii\n";
  checkTwoPoints(readingFile("a.pcd", pcd + rows), "3 points without a finite position below 1e30");
  checkTwoPoints(readingFile("a.xyz", rows), "3 points without a finite position below 1e30");
  checkTwoPoints(readingFile("a.csv", "x,y,z\n1,2,3\n1.#QNAN,0,0\n4,5,6\n7,,8\nNA,1,1\n"),
                 "3 points without a finite position below 1e30");
  checkTwoPoints(readingFile("a.obj", "v 1 2 3\nv nan 0 0\nv 4 5 6\n"), "1 point without a finite position below 1e30");
  checkTwoPoints(readingFile("a.off", "OFF\n3 0 0\n1 2 3\ninf 0 0\n4 5 6\n"),
                 "1 point without a finite position below 1e30");
  const std::string values = npy::bytes({1.f, 2.f, 3.f, NAN, 0.f, 0.f, 4.f, 5.f, 6.f});
  checkTwoPoints(readingFile("a.npy", npy::array("'<f4'", "(3, 3)", values)),
                 "1 point without a finite position below 1e30");
}

TEST_CASE("faces keep their vertices when invalid rows are left out, and faces of such rows are dropped") {
  const StoredCloud stored = readingFile(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement face "
      "2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\nnan 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 2 3\n3 0 1 2\n");
  REQUIRE(stored.triangles.size() == 1);
  CHECK(stored.triangles[0] == std::array<std::uint32_t, 3>{0, 1, 2});
  REQUIRE(stored.lost.size() == 2);
  CHECK(stored.lost[1] == "1 triangle of points that are left out");
}

TEST_CASE("triangles with a non-finite corner are left out and counted, in text STL") {
  const auto facet = [](const char* z) {
    return fmt::format("facet normal 0 0 1\nouter loop\nvertex 0 0 {}\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n",
                       z);
  };
  const StoredCloud stored =
      readingFile("a.stl", "solid a\n" + facet("0") + facet("nan") + "endsolid a\n", {.asTriangles = true});
  CHECK(stored.triangles.size() == 1);
  REQUIRE(stored.lost.size() == 1);
  CHECK(stored.lost[0] == "1 triangle with a corner that is not finite");
}

TEST_CASE("a normal that is not a number is treated as missing") {
  std::string text = "x y z nx ny nz\n";
  for (int k = 0; k < 20; ++k) text += fmt::format("{} 0 0 0 0 {}\n", k, k == 3 ? "nan" : "1");
  const PointCloud cloud = readingFile("a.txt", text).cloud;
  REQUIRE(cloud.normals.size() == 20);
  CHECK(cloud.normals[3] == Vec3(0, 0, 1));  // the normal of the nearest point
}

TEST_CASE("PLY colours from 0 to 1, to 255 and to 65535 give the same colours, in any numeric type") {
  for (const std::string type : {"float", "double"})
    for (const double scale : {1.0 / 255, 1.0, 257.0}) {
      CAPTURE(type);
      CAPTURE(scale);
      checkSheetColors(readingFile("a.ply", plySheet(type, scale)).cloud);
    }
  for (const std::string type : {"ushort", "uint", "int"})
    for (const double scale : {1.0, 257.0}) {
      CAPTURE(type);
      checkSheetColors(readingFile("a.ply", plySheet(type, scale)).cloud);
    }
  const PointCloud dark = readingFile("a.ply", plySheet("float", 1, 7)).cloud;
  REQUIRE(dark.size() == Sheet::kPoints);
  CHECK(dark.colors[6][0] == 50);
  CHECK(int{dark.colors[7][0]} <= 1);  // one dark point does not determine the range of the others
}

TEST_CASE("colours of text, OBJ, OFF and PCD are judged by the whole column, not by its first row") {
  for (const double scale : {1.0 / 255, 1.0, 257.0}) {
    CAPTURE(scale);
    if (scale <= 1) checkSheetColors(readingFile("a.xyz", lines(scale)).cloud);  // larger ones are ambiguous
    checkSheetColors(readingFile("a.txt", lines(scale, "X Y Z R G B\n")).cloud);
    checkSheetColors(readingFile("a.obj", lines(scale, "", "v ")).cloud);
    checkSheetColors(readingFile("a.off", lines(scale, "COFF\n20 0 0\n")).cloud);
    const std::string pcd =
        "VERSION .7\nFIELDS x y z r g b\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\nCOUNT 1 1 1 1 1 1\nWIDTH 20\nHEIGHT 1\n"
        "POINTS 20\nDATA ascii\n";
    checkSheetColors(readingFile("a.pcd", lines(scale, pcd)).cloud);
  }
}

TEST_CASE("integer colours of text are steps of 255, even if all points are dark") {
  const PointCloud cloud = readingFile("a.csv", "x,y,z,red,green,blue\n0,0,0,1,0,0\n1,0,0,0,1,1\n").cloud;
  REQUIRE(cloud.hasColors());
  CHECK(cloud.colors[0] == std::array<std::uint8_t, 4>{1, 0, 0, 255});
}

TEST_CASE("floating-point E57 colours without limits may range to 255" * doctest::skip(!canReadE57())) {
  const std::vector<double> ramp{0, 1, 2, 3}, light{0, 50, 100, 255};
  E57Bytes real;
  real.add({.points = 4,
            .streams = {floats("cartesianX", ramp, true), floats("cartesianY", ramp, true),
                        floats("cartesianZ", ramp, true), floats("colorRed", light, true),
                        floats("colorGreen", light, true), floats("colorBlue", light, true)}});
  const PointCloud cloud = readingFile("a.e57", real.text()).cloud;
  REQUIRE(cloud.colors.size() == 4);
  CHECK(int{cloud.colors[1][0]} == 50);
  CHECK(int{cloud.colors[3][2]} == 255);
}

TEST_CASE("mesh corners without a colour beside coloured ones become white, and are counted") {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 5 1 0 0\nv 1 0 5 1 0 0\nv 0 1 5 1 0 0\nf 1 2 3\nf 4 5 6\n";
  const StoredCloud stored = readingFile("a.obj", obj, {.asTriangles = true});
  REQUIRE(stored.cloud.colors.size() == 6);
  CHECK(stored.cloud.colors[0] == std::array<std::uint8_t, 4>{255, 255, 255, 255});
  CHECK(stored.cloud.colors[5] == std::array<std::uint8_t, 4>{255, 0, 0, 255});
  REQUIRE(stored.lost.size() == 1);
  CHECK(stored.lost[0] == "3 corners have no colour, and are white");
}

TEST_CASE("half a file of any format is refused because it ends early, or is said to be possibly truncated") {
  std::set<std::string> tried;
  for (const Specimen& specimen : specimens()) {
    // Half of these .splat and .ptx files is as well a whole one.
    if (!specimen.beside.empty() || has("splat ptx", specimen.format)) continue;
    if (specimen.format == "e57" && !canReadE57()) continue;
    CAPTURE(specimen.name);
    CAPTURE(specimen.text.size());
    bool isRefused = false;
    const std::string said = saidOfHalf(specimen, isRefused);
    CHECK_MESSAGE((has(said, "ends") || has(said, "truncated")), said);
    const bool states = !has("xyz csv obj", specimen.format);  // how much it contains
    if (states) CHECK(isRefused);
    tried.insert(specimen.format);
  }
  CHECK(tried.size() >= 14);
}

TEST_CASE("half a file of points of equal size is said to end after so many of its points") {
  const ScratchFolder folder;
  PointCloud cloud;
  for (int i = 0; i < 1000; ++i) cloud.positions.emplace_back(i, i % 7, 0);
  for (const char* name : {"a.ply", "a.las", "a.pcd", "a.npy", "a.pts"}) {
    CAPTURE(name);
    const std::filesystem::path file = folder / name;
    writeCloud(file, cloud);
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    const std::string error = errorOf([&] { readCloud(file); });
    const std::size_t at = error.find("ends after ");
    REQUIRE_MESSAGE(at != std::string::npos, error);
    CHECK(std::stoi(error.substr(at + 11)) == within(500, 40));
    CHECK(says(error, "of 1000 "));
    if (std::string_view(name) != "a.pts")
      CHECK(says(error, fmt::format(": byte {}: ", std::filesystem::file_size(file))));
  }
}

TEST_CASE("64-bit whole numbers are exact in every format, and text names those that it would round") {
  constexpr std::int64_t kLow = std::numeric_limits<std::int64_t>::min() + 1;
  constexpr std::uint64_t kTime = 1658393524629456496u;
  const std::string ply = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty int64 "
      "low\nproperty uint64 time\nend_header\n1 2 3 {} {}\n4 5 6 -5 {}\n",
      kLow, kTime, std::numeric_limits<std::uint64_t>::max());
  const StoredCloud read = readingFile("a.ply", ply);
  CHECK(read.lost.empty());
  const ScratchFolder folder;
  for (const char* name : {"b.ply", "b.pcd", "b.npy", "b.npz", "b.las", "b.laz"})
    for (const bool ascii : {false, true}) {
      CAPTURE(name);
      writeCloud(folder / name, read.cloud, {.ascii = ascii});
      const PointCloud back = readCloud(folder / name).cloud;
      REQUIRE(back.extra.size() == 2);
      CHECK(loadScalar<std::int64_t>(back.extra[0].data.data()) == kLow);
      CHECK(loadScalar<std::int64_t>(back.extra[0].data.data() + 8) == -5);
      CHECK(loadScalar<std::uint64_t>(back.extra[1].data.data()) == kTime);
      CHECK(loadScalar<std::uint64_t>(back.extra[1].data.data() + 8) == std::numeric_limits<std::uint64_t>::max());
    }
  writeCloud(folder / "b.csv", read.cloud);
  std::ifstream text(folder / "b.csv");
  std::string line;
  std::getline(text, line);
  std::getline(text, line);
  CHECK(line == fmt::format("1,2,3,{},{}", kLow, kTime));
  const std::vector<std::string> lost = readCloud(folder / "b.csv").lost;
  REQUIRE(lost.size() == 2);
  CHECK(lost[1] == "the last digits of 2 whole numbers in the column 'time', which are beyond 2^53");
}

TEST_CASE("far outliers do not make the positions of the other points coarse") {
  const ScratchFolder folder;
  const auto truth = [](int i) { return DVec3(500000 + 0.001 * i, 4500000.5 - 0.002 * i, 12.25 + 0.001 * (i % 7)); };
  constexpr int kPoints = 400;
  {
    std::ofstream out(folder / "a.xyz");
    for (int i = 0; i < kPoints; ++i) out << fmt::format("{:.3f} {:.3f} {:.3f}\n", truth(i).x, truth(i).y, truth(i).z);
    out << "400000.000 4400000.000 0.000\n1000000.000 5000000.000 0.000\n";
  }
  for (const char* name : {"a.ply", "a.las"}) writeCloud(folder / name, readCloud(folder / "a.xyz").cloud);
  for (const char* name : {"a.xyz", "a.ply", "a.las"}) {
    CAPTURE(name);
    const PointCloud cloud = readCloud(folder / name).cloud;
    REQUIRE(cloud.size() == kPoints + 2);
    double farthest = 0;
    for (int i = 0; i < kPoints; ++i) {
      const DVec3 there = cloud.origin + DVec3(cloud.positions[static_cast<std::size_t>(i)]);
      farthest = std::max(farthest, glm::distance(there, truth(i)));
    }
    CHECK(farthest < 1e-5);
    CHECK(glm::distance(cloud.fileCoordinates(kPoints), DVec3(400000, 4400000, 0)) < 1e-3);
  }
}

}  // namespace palpate::test::every_format_test
