// Points as lines of text, also as Windows, spreadsheets, surveyors and scanners write them: meaning of the columns,
// errors with their line, and lossless conversion.
#include "engine/io/known_formats.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <numbers>

#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "tests/io/file_cases.hpp"

namespace palpate::test::xyz_format_test {

namespace {

using Color = std::array<std::uint8_t, 4>;

StoredCloud reading(const std::string& text, const char* name = "a.xyz", const CloudReadOptions& options = {}) {
  return readingFile(name, text, options);
}

PointCloud again(const PointCloud& cloud) {
  const ScratchFolder folder;
  writeCloud(folder / "b.xyz", cloud, {});
  CHECK(contentsOf(folder / "b.xyz").elements.at(0).count == cloud.size());
  return readCloud(folder / "b.xyz").cloud;
}

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

TEST_CASE("unnamed text columns are positions, an intensity, normals or colours") {
  const PointCloud places = reading("1 2 3\n4 5 6.5\n").cloud;
  REQUIRE(places.size() == 2);
  CHECK(places.fileCoordinates(1) == DVec3(4, 5, 6.5));
  CHECK(!places.hasNormals());
  CHECK(!places.hasColors());

  const PointCloud lit = reading("1 2 3 0.25\n").cloud;
  REQUIRE(lit.extra.size() == 1);
  CHECK(lit.extra[0].name == "intensity");

  const PointCloud facing = reading("1 2 3 0 0 1\n").cloud;  // not dark blue
  REQUIRE(facing.hasNormals());
  CHECK(facing.normals[0] == Vec3(0, 0, 1));

  const PointCloud colored = reading("1 2 3 255 0 7\n").cloud;
  REQUIRE(colored.hasColors());
  CHECK(colored.colors[0] == Color{255, 0, 7, 255});
}

TEST_CASE("a header line names the columns, also as a comment") {
  for (const char* names : {"x,y,z,r,g,b,Scan", "//X Y Z R G B Scan", "# x y z r g b Scan"}) {
    CAPTURE(names);
    const PointCloud cloud = reading(std::string("# made by hand\n\n") + names + "\n1;2\t3, 9 8 7 4.5\n").cloud;
    REQUIRE(cloud.size() == 1);
    CHECK(cloud.fileCoordinates(0) == DVec3(1, 2, 3));
    CHECK(cloud.colors.at(0) == Color{9, 8, 7, 255});
    REQUIRE(cloud.extra.size() == 1);
    CHECK(cloud.extra[0].name == "Scan");
  }
  CHECK(reading("nx ny nz x y z\n0 1 0 7 8 9\n").cloud.normals.at(0) == Vec3(0, 1, 0));
  CHECK(reading("x y z red green blue\n0 0 0 0.5 1.0 0\n").cloud.colors.at(0)[0] == 128);
}

TEST_CASE("comments, blank lines and any line ends are allowed between points") {
  CHECK(reading("1 2 3\n# one\n\n  \n// two\n4 5 6\n").cloud.size() == 2);
  CHECK(reading("1 2 3\r\n4 5 6\r\n").cloud.size() == 2);
  CHECK(reading("1 2 3\r4 5 6").cloud.size() == 2);
  refuses("a.xyz", "", ": is empty; it contains no points");
  CHECK(reading("# nothing\n").cloud.empty());
  CHECK(reading("x y z\n").cloud.empty());
}

TEST_CASE("a text line that is not a point is refused with its line") {
  refuses("a.xyz", "hello world\n",
          ":1: found 'hello', expected the coordinates of a point, or names of columns with x, y and z among them; "
          "--columns x,y,z names them in their place");
  refuses("a.xyz", "1 2 3\n4 five 6\n", ":2: found 'five' for 'y', expected a number");
  refuses("a.xyz", "1 2 3\n4 5\n", ":2: a point of 2 columns where those before have 3");
  refuses("a.xyz", "# a\n1 2 3 4 5\n", ":2: a point of 5 columns, which may mean anything...");
  refuses("a.xyz", "1 2 3 0.1 0.2 3.5\n", ":1: columns 4 to 6 have no names...");
  refuses("a.xyz", "x y z w\n1 2 3\n", ":2: a point of 3 columns, of which 4 have names");
  refuses("a.xyz", "1 2 3 4 5 6\n1 2 3 4 5 256\n", ":1: columns 4 to 6 have no names...");
  refuses("a.xyz", std::string(2 << 20, '1'), ":1: ...");
}

TEST_CASE("a written text cloud is read back unchanged") {
  PointCloud cloud;
  for (int i = 0; i < 5000; ++i) {  // more than one batch
    cloud.positions.emplace_back(0.1f * static_cast<float>(i), 1 / 3.0f, std::numbers::pi_v<float>);
    cloud.normals.emplace_back(0, 0, i % 2 == 0 ? 1 : -1);
    cloud.colors.push_back({static_cast<std::uint8_t>(i), 2, 3, 255});
  }
  const PointCloud read = again(cloud);
  REQUIRE(read.size() == cloud.size());
  CHECK(read.positions == cloud.positions);
  CHECK(read.normals == cloud.normals);
  CHECK(read.colors == cloud.colors);

  const PointCloud carried = reading("x y z weight\n4500000.001 5200000.002 0.003 7\n").cloud;
  const PointCloud carriedAgain = again(carried);
  CHECK(carriedAgain.fileCoordinates(0) == DVec3(4500000.001, 5200000.002, 0.003));
  REQUIRE(carriedAgain.extra.size() == 1);
  CHECK(carriedAgain.extra[0].data == carried.extra[0].data);
}

TEST_CASE("a PTS file gives the number of points of each scan") {
  const PointCloud cloud = reading("2\n1 2 3 -100 255 0 7\n4 5 6 20 1 2 3\n\n1\n7 8 9 0 4 5 6\n", "a.pts").cloud;
  REQUIRE(cloud.size() == 3);
  CHECK(cloud.fileCoordinates(2) == DVec3(7, 8, 9));
  CHECK(cloud.colors.at(0) == Color{255, 0, 7, 255});
  REQUIRE(cloud.extra.size() == 1);
  CHECK(cloud.extra[0].name == "intensity");
  CHECK(loadScalar<double>(cloud.extra[0].data.data()) == -100);
  CHECK(reading("1 2 3\n", "a.pts").cloud.size() == 1);
  CHECK(reading("0\n", "a.pts").cloud.empty());
  refuses("a.pts", "2\n1 2 3\n", ":2: ends after 1 of 2 points");
  refuses("a.pts", "2\n1 2 3\n1\n4 5 6\n", ":3: ends after 1 of 2 points");
  refuses("a.pts", "1\n1 2 3\n4 5 6\n", ":3: more than the 1 points that were promised");
  refuses("a.pts", "3\n", ":1: ends after 0 of 3 points");
  refuses("a.pts", "1 2 3\nfour\n", ":2: found 'four', expected a point, or the number of points");
  refuses("a.xyz", "1\n1 2 3\n", "read");  // also under another ending

  for (const bool lit : {false, true}) {
    PointCloud some = cloud;
    if (!lit) some.extra.clear();
    const ScratchFolder folder;
    writeCloud(folder / "b.pts", some);
    const PointCloud back = readCloud(folder / "b.pts").cloud;
    CHECK(back.positions == some.positions);
    CHECK(back.colors == some.colors);
    CHECK(loadScalar<double>(back.extra.at(0).data.data()) == (lit ? -100 : 0));
  }
  StoredCloud more{.cloud = cloud, .triangles = {{0, 1, 2}}, .lost = {}};
  more.cloud.normals.assign(3, Vec3(0, 0, 1));
  more.cloud.extra.push_back({"ring", ScalarType::u8, std::vector<std::byte>(3)});
  CHECK(lostOnTheWay(more, ptsFormat()) == std::vector<std::string>{"1 triangle", "normals", "the column 'ring'"});
}

TEST_CASE("CSV has names in its first line, quoted or not, and commas") {
  const PointCloud cloud =
      reading("\"X\",\"Y\",Z,Normal_X,Normal_Y,Normal_Z,\"Score\"\r\n1,2,3,0,1,0,0.25\r\n", "a.csv").cloud;
  REQUIRE(cloud.size() == 1);
  CHECK(cloud.fileCoordinates(0) == DVec3(1, 2, 3));
  CHECK(cloud.normals.at(0) == Vec3(0, 1, 0));
  REQUIRE(cloud.extra.size() == 1);
  CHECK(cloud.extra[0].name == "Score");
  const ScratchFolder folder;
  writeCloud(folder / "b.csv", cloud);
  std::string text;
  std::getline(std::ifstream(folder / "b.csv"), text);
  CHECK(text == "x,y,z,nx,ny,nz,Score");
  const PointCloud back = readCloud(folder / "b.csv").cloud;
  CHECK(back.positions == cloud.positions);
  CHECK(back.normals == cloud.normals);
  CHECK(back.extra.at(0).data == cloud.extra[0].data);
  const PointCloud twice = reading("x,y,z,a,A,a\n1,2,3,4,5,6\n", "a.csv").cloud;
  REQUIRE(twice.extra.size() == 3);
  CHECK(twice.extra[1].name == "A");
  CHECK(twice.extra[2].name == "a_2");
  CHECK(reading("x,y,z\n1,,3\n", "a.csv").lost ==
        std::vector<std::string>{"1 point without a finite position below 1e30"});
  refuses("a.csv", "x,y,z\n1,3\n", ":2: a point of 2 columns, of which 3 have names");
}

TEST_CASE("column names keep their case from LAS to text and back") {
  const ScratchFolder folder;
  PointCloud cloud;
  for (int i = 0; i < 5; ++i) cloud.positions.emplace_back(i, 2 * i, 0.5f);
  for (const char* name : {"intensity", "Intensity", "Colors_0", "Height Above"}) {
    Attribute& added = cloud.extra.emplace_back(Attribute{name, ScalarType::u16, {}});
    for (std::uint16_t i = 0; i < 5; ++i) {
      const std::uint16_t value = static_cast<std::uint16_t>(10 * cloud.extra.size() + i);
      const auto* bytes = reinterpret_cast<const std::byte*>(&value);
      added.data.insert(added.data.end(), bytes, bytes + sizeof value);
    }
  }
  writeCloud(folder / "a.las", cloud);
  const auto valuesOf = [](const PointCloud& of, std::string_view name) {
    const auto found = std::ranges::find(of.extra, name, &Attribute::name);
    std::vector<double> values;
    for (std::size_t i = 0; found != of.extra.end() && i < of.size(); ++i)
      visitScalar(found->type, [&]<class T>(std::type_identity<T>) {
        values.push_back(static_cast<double>(loadScalar<T>(found->data.data() + i * sizeof(T))));
      });
    return values;
  };
  for (const char* between : {"a.csv", "a.xyz", "a.txt"}) {
    CAPTURE(std::string(between));
    writeCloud(folder / between, readCloud(folder / "a.las").cloud);
    writeCloud(folder / "b.las", readCloud(folder / between).cloud);
    const PointCloud back = readCloud(folder / "b.las").cloud;
    CHECK(valuesOf(back, "intensity") == std::vector<double>{10, 11, 12, 13, 14});
    CHECK(valuesOf(back, "Intensity") == std::vector<double>{20, 21, 22, 23, 24});
    CHECK(valuesOf(back, "Colors_0") == std::vector<double>{30, 31, 32, 33, 34});
  }
  // Positions, normals and colours are recognized in any case.
  const PointCloud known = reading("X,Y,Z,Normal_X,NORMAL_Y,nz,R,g,B\n1,2,3,0,0,1,7,8,9\n", "a.csv").cloud;
  CHECK(known.normals.at(0) == Vec3(0, 0, 1));
  CHECK(known.colors.at(0) == Color{7, 8, 9, 255});
}

TEST_CASE("given column names override those of the file") {
  const CloudReadOptions options{.columns = {"z", "y", "x", "red", "green", "blue", "kind"}};
  const PointCloud cloud = reading("3 2 1 9 8 7 5\n", "a.txt", options).cloud;
  CHECK(cloud.fileCoordinates(0) == DVec3(1, 2, 3));
  CHECK(cloud.colors.at(0) == Color{9, 8, 7, 255});
  CHECK(cloud.extra.at(0).name == "kind");
  CHECK(reading("x y z a b c d\n3 2 1 9 8 7 5\n", "a.asc", options).cloud.fileCoordinates(0) == DVec3(1, 2, 3));
  CHECK_THROWS_WITH_AS(reading("1 2 3\n", "a.xyz", options),
                       doctest::Contains(":1: a point of 3 columns, of which 7 have names"), FileError);
}

TEST_CASE("properties that text cannot hold are listed") {
  StoredCloud stored{.cloud = reading("1 2 3\n").cloud, .triangles = {{0, 0, 0}}, .lost = {}};
  stored.cloud.storedAs.comments = {"comment by somebody"};
  stored.cloud.storedAs.alpha = true;
  CHECK(lostOnTheWay(stored, xyzFormat()) ==
        std::vector<std::string>{"1 triangle", "comments", "the alpha of colours"});
}

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
  // Points without an echo may have other columns than the others; a point may lack its colour.
  const std::string mixed =
      "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n0 0 0 0.5\n1 1 1 0.5 255 0 0\n";
  const StoredCloud echoes = readingFile("a.ptx", mixed + "2 1 1 0.5 0 255 0\n2 2 1 0.5\n");
  REQUIRE(echoes.cloud.size() == 3);
  CHECK(echoes.cloud.colors[1] == std::array<std::uint8_t, 4>{0, 255, 0, 255});
  CHECK(echoes.lost[0] == "colours of 1 point that are not numbers, which are black");
  refuses("a.ptx", mixed + "2 1 1 0.5 7\n", ":13: a point of 5 numbers...");
  std::string plain = mixed;
  plain.replace(plain.rfind(" 255 0 0"), 8, "");
  CHECK_FALSE(readingFile("a.ptx", plain + "0 0 0 0.5 0 0 0\n2 2 1 0.5\n").cloud.hasColors());
  refuses("a.ptx", plain + "2 2 1 0.5 1 2 3\n", ":13: a point of 7 numbers...");
  refuses("a.ptx", scan.substr(0, scan.find("2 2 1")), ":13: the file ends after 3 of 4 points of scan 1");
  refuses("a.ptx", "2\n5000000000\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 1 1 1\n",
          "...ends after 1 of 10000000000 points...");
}

}  // namespace palpate::test::xyz_format_test
