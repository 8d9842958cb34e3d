#include "engine/io/ply_format.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/core/error.hpp"
#include "tests/io/ply_bytes.hpp"

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
  CHECK(ply.lacks(cloud).empty());
  cloud.cloud.normals = {Vec3(0, 0, 1)};
  CHECK(ply.lacks(cloud).size() == 1);
  CHECK(names(ply.lacks(cloud), "'nx' of vertex"));
}

}  // namespace palpate::test::ply_format_test
