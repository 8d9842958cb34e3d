// Points as lines of text: what columns mean, what is refused with its line, and that nothing is lost on the way.
#include "engine/io/xyz_format.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <numbers>

#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::test {
namespace {

using Color = std::array<std::uint8_t, 4>;

StoredCloud reading(const std::string& text) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / "a.xyz";
  std::ofstream(file, std::ios::binary) << text;
  return readCloud(file);
}

std::string refusal(const std::string& text) {
  try {
    reading(text);
  } catch (const FileError& error) {
    const std::string message = error.what();
    return message.substr(message.find(".xyz") + 4);
  }
  return "read";
}

PointCloud again(const PointCloud& cloud) {
  const ScratchFolder folder;
  writeCloud(folder / "b.xyz", cloud, {});
  CHECK(contentsOf(folder / "b.xyz").elements.at(0).count == cloud.size());
  return readCloud(folder / "b.xyz").cloud;
}

}  // namespace

TEST_CASE("columns without names are places, an intensity, normals or colours") {
  const PointCloud places = reading("1 2 3\n4 5 6.5\n").cloud;
  REQUIRE(places.size() == 2);
  CHECK(places.fileCoordinates(1) == DVec3(4, 5, 6.5));
  CHECK(!places.hasNormals());
  CHECK(!places.hasColors());

  const PointCloud lit = reading("1 2 3 0.25\n").cloud;
  REQUIRE(lit.extra.size() == 1);
  CHECK(lit.extra[0].name == "intensity");

  const PointCloud facing = reading("1 2 3 0 0 1\n").cloud;  // no dark blue
  REQUIRE(facing.hasNormals());
  CHECK(facing.normals[0] == Vec3(0, 0, 1));

  const PointCloud colored = reading("1 2 3 255 0 7\n").cloud;
  REQUIRE(colored.hasColors());
  CHECK(colored.colors[0] == Color{255, 0, 7, 255});
}

TEST_CASE("a line of names says what columns are, also behind the sign of a remark") {
  for (const char* names : {"x,y,z,r,g,b,Scan", "//X Y Z R G B Scan", "# x y z r g b scan"}) {
    CAPTURE(names);
    const PointCloud cloud = reading(std::string("# made by hand\n\n") + names + "\n1;2\t3, 9 8 7 4.5\n").cloud;
    REQUIRE(cloud.size() == 1);
    CHECK(cloud.fileCoordinates(0) == DVec3(1, 2, 3));
    CHECK(cloud.colors.at(0) == Color{9, 8, 7, 255});
    REQUIRE(cloud.extra.size() == 1);
    CHECK(cloud.extra[0].name == "scan");
  }
  CHECK(reading("nx ny nz x y z\n0 1 0 7 8 9\n").cloud.normals.at(0) == Vec3(0, 1, 0));
  CHECK(reading("x y z red green blue\n0 0 0 0.5 1.0 0\n").cloud.colors.at(0)[0] == 128);
}

TEST_CASE("remarks, blank lines and any ends of lines stand between points") {
  CHECK(reading("1 2 3\n# one\n\n  \n// two\n4 5 6\n").cloud.size() == 2);
  CHECK(reading("1 2 3\r\n4 5 6\r\n").cloud.size() == 2);
  CHECK(reading("1 2 3\r4 5 6").cloud.size() == 2);
  CHECK(reading("").cloud.empty());
  CHECK(reading("# nothing\n").cloud.empty());
  CHECK(reading("x y z\n").cloud.empty());
}

TEST_CASE("what is no point is refused with its line") {
  CHECK(refusal("hello world\n") ==
        ":1: found 'hello', expected the coordinates of a point, or names of columns with x, y and z among them");
  CHECK(refusal("1 2 3\n4 five 6\n") == ":2: found 'five' for 'y', expected a number");
  CHECK(refusal("1 2 3\n4 5\n") == ":2: a point of 2 columns where those before have 3");
  CHECK(refusal("# a\n1 2 3 4 5\n").starts_with(":2: a point of 5 columns, which may mean anything"));
  CHECK(refusal("1 2 3 0.1 0.2 3.5\n").starts_with(":1: a point of 6 columns, which may mean anything"));
  CHECK(refusal("x y z w\n1 2 3\n") == ":2: a point of 3 columns, of which 4 have names");
  CHECK(refusal("1 2 3 4 5 6\n1 2 3 4 5 256\n").starts_with(":2: found '256' for 'blue', expected a number from 0 to 255"));
  CHECK(refusal("1 2 3\n1 2 nan\n").starts_with(":2: "));
  CHECK(refusal("1 2 3\n1 1e999 3\n").starts_with(":2: "));
  CHECK(refusal(std::string(2 << 20, '1')).starts_with(":1: "));
}

TEST_CASE("what is written reads back as it was") {
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
  CHECK(again({}).empty());
}

TEST_CASE("what text has no place for is named") {
  StoredCloud stored{.cloud = reading("1 2 3\n").cloud, .triangles = {{0, 0, 0}}, .lost = {}};
  stored.cloud.storedAs.comments = {"comment by somebody"};
  stored.cloud.storedAs.alpha = true;
  CHECK(xyzFormat().lacks(stored) == std::vector<std::string>{"1 triangles", "comments", "the alpha of colours"});
}

}  // namespace palpate::test
