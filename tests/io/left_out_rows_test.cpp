// Rows that are not valid points are left out and counted, in every format.
#include <cmath>

#include "tests/io/file_cases.hpp"
#include "tests/io/npy_bytes.hpp"

namespace palpate::test::left_out_rows_test {
namespace {

void checkTwoPoints(const StoredCloud& stored, const std::string& count) {
  REQUIRE(stored.cloud.size() == 2);
  CHECK(stored.cloud.fileCoordinates(0) == DVec3(1, 2, 3));
  CHECK(stored.cloud.fileCoordinates(1) == DVec3(4, 5, 6));
  REQUIRE_FALSE(stored.lost.empty());
  CHECK(stored.lost[0] == count);
}

}  // namespace

TEST_CASE("rows without a finite position are left out and counted: PLY, PCD, text, NPY, OBJ, OFF") {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  const std::string rows = "1 2 3\nnan nan nan\n1 inf 0\n4 5 6\n-nan 0 -inf\n";
  checkTwoPoints(readingFile("a.ply", ply + rows), "3 points without a finite position");
  const std::string pcd =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 5\nHEIGHT 1\nPOINTS 5\nDATA ascii\n";
  checkTwoPoints(readingFile("a.pcd", pcd + rows), "3 points without a finite position");
  checkTwoPoints(readingFile("a.xyz", rows), "3 points without a finite position");
  checkTwoPoints(readingFile("a.csv", "x,y,z\n1,2,3\n1.#QNAN,0,0\n4,5,6\n7,,8\nNA,1,1\n"),
                 "3 points without a finite position");
  checkTwoPoints(readingFile("a.obj", "v 1 2 3\nv nan 0 0\nv 4 5 6\n"), "1 point without a finite position");
  checkTwoPoints(readingFile("a.off", "OFF\n3 0 0\n1 2 3\ninf 0 0\n4 5 6\n"), "1 point without a finite position");
  const std::string values = npy::bytes({1.f, 2.f, 3.f, NAN, 0.f, 0.f, 4.f, 5.f, 6.f});
  checkTwoPoints(readingFile("a.npy", npy::array("'<f4'", "(3, 3)", values)), "1 point without a finite position");
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

}  // namespace palpate::test::left_out_rows_test
