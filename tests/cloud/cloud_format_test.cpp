#include "engine/cloud/cloud_format.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/core/error.hpp"
#include "tests/cloud/ply_bytes.hpp"

namespace palpate::test {
namespace {

StoredCloud stored(const std::string& elements, const std::string& rows) {
  const TemporaryFile file("ply\nformat ascii 1.0\n" + elements + "end_header\n" + rows);
  return formatToRead(file.path()).read(file.path(), nullptr, {});
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "element face 2\nproperty list uchar int vertex_indices\n";

bool names(const std::vector<std::string>& lost, std::string_view what) {
  return std::ranges::any_of(lost, [&](const std::string& one) { return contains(one, what); });
}

}  // namespace

TEST_CASE("a format is known by its ending; others are refused for writing, with those that there are") {
  CHECK(formatToWrite("folder.x/cloud.PLY").name == "PLY");
  CHECK(formatToRead("cloud.ply").name == "PLY");
  CHECK(formatToRead("no-ending").name == "PLY");
  CHECK_THROWS_WITH_AS(formatToWrite("cloud.xyzzy"), doctest::Contains(".ply"), UsageError);
  CHECK_THROWS_AS(formatToWrite("cloud"), UsageError);
}

TEST_CASE("a cloud that is written as it was read loses nothing") {
  const StoredCloud cloud =
      stored("element vertex 3\n" + kXyz + "property uchar red\nproperty uchar green\nproperty uchar blue\n" + kFaces,
             "0 0 0 1 2 3\n1 0 0 4 5 6\n0 1 0 7 8 9\n3 0 1 2\n3 2 1 0\n");
  CHECK(cloud.lost.empty());
  CHECK(cloud.triangles.size() == 2);
}

TEST_CASE("all that is lost by reading is named") {
  const StoredCloud cloud = stored(
      "element vertex 4\n" + kXyz + "property list uchar int links\nproperty ushort red\nproperty ushort green\n" +
          "property ushort blue\n" + kFaces + "property uchar material\nelement edge 1\nproperty int a\n" +
          "element nothing 0\nproperty int a\n",
      "0 0 0 0 1 2 3\n1 0 0 0 4 5 6\n0 1 0 0 7 8 9\n1 1 0 1 5 7 8 9\n3 0 1 2 7\n4 0 1 3 2 7\n5\n");
  CHECK(cloud.lost.size() == 5);
  CHECK(names(cloud.lost, "'links' of vertex"));
  CHECK(names(cloud.lost, "'material' of face"));
  CHECK(names(cloud.lost, "1 edge"));
  CHECK(names(cloud.lost, "2 faces, which become 3 triangles"));
  CHECK(names(cloud.lost, "8 bits"));
}

TEST_CASE("what gives way to normals that came later is named") {
  StoredCloud cloud = stored("element vertex 1\n" + kXyz + "property float nx\nproperty float heat\n", "0 0 0 5 6\n");
  const CloudFormat& ply = formatToWrite("a.ply");
  CHECK(ply.lacks(cloud).empty());
  cloud.cloud.normals = {Vec3(0, 0, 1)};
  CHECK(ply.lacks(cloud).size() == 1);
  CHECK(names(ply.lacks(cloud), "'nx' of vertex"));
}

TEST_CASE("every format that is written is read back, point by point") {
  StoredCloud cloud = stored("element vertex 3\n" + kXyz + "property double heat\n" + kFaces,
                             "0 0 0.125 0.1\n1 0 0 0.2\n0 1 0 0.3\n3 0 1 2\n3 2 1 0\n");
  for (const CloudFormat& format : cloudFormats())
    for (const bool ascii : {false, true}) {
      if (!format.write || !format.read) continue;
      const TemporaryFile file;
      format.write(file.path(), cloud, {.ascii = ascii});
      const StoredCloud again = format.read(file.path(), nullptr, {});
      CHECK(again.cloud.positions == cloud.cloud.positions);
      CHECK(again.triangles == cloud.triangles);
      REQUIRE(again.cloud.extra.size() == 1);
      CHECK(again.cloud.extra[0].data == cloud.cloud.extra[0].data);
      CHECK(again.lost.empty());
    }
}

}  // namespace palpate::test
