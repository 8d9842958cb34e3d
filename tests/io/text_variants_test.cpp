// Text as Windows, spreadsheets, surveyors and scanners write it.
#include "tests/io/file_cases.hpp"

namespace palpate::test::text_variants_test {
namespace {

std::string sheetLines(const std::string& between, bool comma, const std::string& quote = "") {
  std::string text;
  for (int k = 0; k < Sheet::kPoints; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      std::string number = fmt::format("{:.3f}", Sheet::place(k)[axis]);
      if (comma) number.replace(number.find('.'), 1, ",");
      text += quote + number + quote + (axis < 2 ? between : "\n");
    }
  return text;
}

std::string utf16(const std::string& text, bool bigEndian, bool mark) {
  std::string out;
  const auto put = [&](unsigned unit) {
    const char high = static_cast<char>(unit >> 8), low = static_cast<char>(unit & 0xff);
    out += bigEndian ? std::string{high, low} : std::string{low, high};
  };
  if (mark) put(0xfeff);
  for (const char c : text) put(static_cast<unsigned char>(c));
  return out;
}

}  // namespace

TEST_CASE("decimal commas are read if another character separates the numbers") {
  checkSheetPlaces(readingFile("a.xyz", sheetLines(" ", true)).cloud);
  checkSheetPlaces(readingFile("a.txt", sheetLines("\t", true)).cloud);
  checkSheetPlaces(readingFile("a.csv", "x;y;z\n" + sheetLines(";", true)).cloud);
  checkSheetPlaces(readingFile("a.csv", sheetLines(",", true, "\"")).cloud);
  checkSheetPlaces(readingFile("a.csv", sheetLines(",", false)).cloud);
  checkSheetPlaces(readingFile("a.csv", sheetLines(", ", false)).cloud);
  refuses("a.csv", "x,y,z\n" + sheetLines(",", true), "...if its commas are decimal ones...");
}

TEST_CASE("UTF-8 with a byte order mark and UTF-16 of either byte order are read") {
  const std::string text = "x,y,z\r\n" + sheetLines(",", false);
  checkSheetPlaces(readingFile("a.csv", "\xef\xbb\xbf" + text).cloud);
  for (const bool bigEndian : {false, true})
    for (const bool mark : {false, true}) checkSheetPlaces(readingFile("a.csv", utf16(text, bigEndian, mark)).cloud);
  checkSheetPlaces(readingFile("a.off", utf16("OFF 20 0 0\n" + sheetLines(" ", false), false, true)).cloud);
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 20\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  checkSheetPlaces(readingFile("a.ply", "\xef\xbb\xbf" + ply + sheetLines(" ", false)).cloud);
}

TEST_CASE("UTF-16 longer than one read buffer is read to its end") {
  std::string text;
  for (int k = 0; k < 80'000; ++k) text += fmt::format("{} {} 0.5\n", k, k % 7);
  const PointCloud cloud = readingFile("a.xyz", utf16(text, false, true)).cloud;
  REQUIRE(cloud.size() == 80'000);
  CHECK(cloud.fileCoordinates(79'999) == DVec3(79'999, 79'999 % 7, 0.5));
}

TEST_CASE("columns are recognized by the names that surveyors and other programs use") {
  const PointCloud survey =
      readingFile("a.csv", "ID,Easting [m],Northing [m],Height,R,G,B\n7,500000.25,5500000.5,1,255,0,1\n").cloud;
  REQUIRE(survey.size() == 1);
  CHECK(survey.fileCoordinates(0) == DVec3(500000.25, 5500000.5, 1));
  CHECK(survey.colors[0] == std::array<std::uint8_t, 4>{255, 0, 1, 255});
  const PointCloud upper =
      readingFile("a.ply",
                  "ply\nformat ascii 1.0\nelement vertex 1\nproperty float X\nproperty float Y\nproperty float "
                  "Z\nproperty float normal_x\nproperty float normal_y\nproperty float normal_z\nproperty uchar "
                  "Red\nproperty uchar Green\nproperty uchar Blue\nend_header\n1 2 3 0 0 1 9 8 7\n")
          .cloud;
  REQUIRE(upper.size() == 1);
  CHECK(upper.hasNormals());
  CHECK(upper.colors[0] == std::array<std::uint8_t, 4>{9, 8, 7, 255});
  CHECK(upper.extra.empty());
}

TEST_CASE("unnamed columns 4 to 6 are normals if all rows allow it, and refused if they can be nothing") {
  std::string facing = "0 0 0 0 0 0\n";  // a missing normal
  for (int k = 1; k < 20; ++k) facing += fmt::format("{} 0 0 0 {} 0\n", k, k % 2 == 0 ? -1 : 1);
  CHECK_FALSE(readingFile("a.xyz", facing).cloud.hasColors());
  const PointCloud colored = readingFile("a.xyz", "0 0 0 0 0 1\n1 0 0 0.2 0 0.8\n").cloud;
  CHECK_FALSE(colored.hasNormals());
  CHECK(colored.hasColors());
  refuses("a.xyz", "0 0 0 -3 0 1\n1 0 0 7 0 0\n", "...columns 4 to 6...");
}

TEST_CASE("PTX: scans are placed by their matrices, and points without an echo are left out") {
  const std::string scan =
      "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n100 200 300 1\n1 0 0 0.5 255 0 0\n0 0 0 0.5 0 0 "
      "0\n2 0 0 0.25 0 9 0\n2 2 1 0.75 1 2 3\n";
  const StoredCloud stored = readingFile("a.ptx", scan + scan);
  REQUIRE(stored.cloud.size() == 6);
  CHECK(stored.cloud.fileCoordinates(0) == DVec3(100, 201, 300));
  CHECK(stored.cloud.fileCoordinates(2) == DVec3(98, 202, 301));
  CHECK(stored.cloud.colors[0] == std::array<std::uint8_t, 4>{255, 0, 0, 255});
  REQUIRE(stored.cloud.extra.size() == 2);
  CHECK(stored.cloud.extra[0].name == "intensity");
  CHECK(stored.cloud.extra[1].name == "scan");
  REQUIRE(stored.lost.size() == 3);
  CHECK(stored.lost[0] == "2 points without an echo");
  refuses("a.ptx", scan.substr(0, scan.find("2 2 1")), ":13: the file ends after 3 of 4 points of scan 1");
  refuses("a.ptx", "2\n5000000000\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 1 1 1\n",
          "...ends after 1 of 10000000000 points...");
}

}  // namespace palpate::test::text_variants_test
