// The range of colour values is determined from the whole column, in every format.
#include "engine/io/e57_scans.hpp"
#include "tests/io/e57_bytes.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/io/ply_bytes.hpp"

namespace palpate::test::color_columns_test {
namespace {

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

}  // namespace

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

}  // namespace palpate::test::color_columns_test
