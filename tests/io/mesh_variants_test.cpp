// Meshes as other programs write them: points without faces, missing spaces, polygons that touch themselves.
#include <glm/geometric.hpp>

#include "tests/io/file_cases.hpp"
#include "tests/io/gltf_bytes.hpp"
#include "tests/near.hpp"

namespace palpate::test::mesh_variants_test {
namespace {

double areaOf(const StoredCloud& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const DVec3 p = mesh.cloud.fileCoordinates(a);
    area += 0.5 * glm::length(glm::cross(mesh.cloud.fileCoordinates(b) - p, mesh.cloud.fileCoordinates(c) - p));
  }
  return area;
}

double areaIn(const std::string& name, const std::string& text) {
  return areaOf(readingFile(name, text, {.asTriangles = true}));
}

}  // namespace

TEST_CASE("polygons with bridged holes, or that touch themselves, have the area they enclose: OBJ, OFF, PLY") {
  const std::string corners = "0 0 0\n8 0 0\n8 8 0\n0 8 0\n2 2 0\n2 6 0\n6 6 0\n6 2 0\n";
  CHECK(areaIn("a.off", "OFF\n8 1 0\n" + corners + "10 0 1 2 3 0 4 5 6 7 4\n") == near(48, 1e-12));
  CHECK(areaIn("a.ply",
               "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement "
               "face 1\nproperty list uchar int vertex_indices\nend_header\n" +
                   corners + "10 0 1 2 3 0 4 5 6 7 4\n") == near(48, 1e-12));
  CHECK(areaIn("a.obj", "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 8 4 0\nv 8 8 0\nv 4 8 0\nv 0 4 0\nf 1 2 3 4 5 6 3 7\n") ==
        near(32, 1e-12));
  CHECK(areaIn("a.obj", "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 1 2 3 4\n") == near(4, 1e-12));  // a concave corner
}

TEST_CASE("concave faces of a PLY file are triangulated correctly, not as fans") {
  CHECK(areaIn("a.ply",
               "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement "
               "face 1\nproperty list uchar int vertex_indices\nend_header\n4 0 0\n1 1 0\n0 4 0\n0 0 0\n4 0 1 2 3\n") ==
        near(4, 1e-12));
}

TEST_CASE("OBJ and OFF files without faces are read as points, with their normals") {
  const PointCloud obj = readingFile("a.obj", "v 1 2 3\nvn 0 0 2\nv 4 5 6\nvn 1 0 0\n").cloud;
  REQUIRE(obj.size() == 2);
  REQUIRE(obj.hasNormals());
  CHECK(obj.normals[0] == Vec3(0, 0, 1));
  CHECK(readingFile("a.off", "OFF\n2 0 0\n1 2 3\n4 5 6\n").cloud.size() == 2);
  refuses("a.obj", "# nothing\no a\n", ": has neither triangles nor points");
}

TEST_CASE("the keyword OFF may be lower-case or joined to the number that follows") {
  for (const char* head : {"OFF3 1 0\n", "off\n3 1 0\n", "OFF 3 1 0\n"}) {
    CAPTURE(head);
    CHECK(areaIn("a.off", std::string(head) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n") == near(0.5, 1e-12));
  }
}

TEST_CASE("binary STL that begins like text, with bytes after its triangles, is read as binary") {
  std::string stl(80, ' ');
  stl.replace(0, 11, "solid model");
  const std::uint32_t count = 1;
  stl.append(reinterpret_cast<const char*>(&count), 4);
  for (const float value : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
    stl.append(reinterpret_cast<const char*>(&value), 4);
  stl += std::string("\0\0", 2) + "behind";
  const StoredCloud stored = readingFile("a.stl", stl, {.asTriangles = true});
  CHECK(areaOf(stored) == near(0.5, 1e-12));
  REQUIRE(stored.lost.size() == 1);
  CHECK(stored.lost[0] == "6 bytes after the last of 1 triangle");
}

TEST_CASE("points of glTF are read as points, and Draco compression is named in the error") {
  std::string gltf = gltfTriangle(false);
  const std::size_t mode = gltf.find("\"attributes\"");
  REQUIRE(mode != std::string::npos);
  CHECK(readingFile("a.gltf", std::string(gltf).insert(mode, "\"mode\":0,")).cloud.size() == 3);
  const std::string draco =
      std::string(gltf).insert(gltf.find("\"asset\""), "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],");
  refuses("a.gltf", draco, "...compressed with Draco...");
}

}  // namespace palpate::test::mesh_variants_test
