// Meshes on the host: reports about their edges, and files.
#include "engine/mesh/mesh.hpp"

#include <doctest/doctest.h>

#include "engine/io/ply_reader.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::mesh_test {

namespace {

Mesh tetrahedron(const Vec3& at = Vec3(0)) {
  Mesh mesh;
  mesh.vertices.positions = {at, at + Vec3(1, 0, 0), at + Vec3(0, 1, 0), at + Vec3(0, 0, 1)};
  mesh.vertices.normals.assign(4, Vec3(0, 0, 1));
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

}  // namespace

TEST_CASE("a tetrahedron is closed and has Euler number 2 and the right volume and area") {
  const MeshReport report = examine(tetrahedron(Vec3(100, -50, 3)));
  CHECK(report.closed());
  CHECK(report.edges == 6);
  CHECK(report.euler() == 2);
  CHECK(report.parts == 1);
  CHECK(report.flat == 0);
  CHECK(report.volume == near(1.0 / 6, 1e-6));
  CHECK(report.area == near(1.5 + std::sqrt(3.0) / 2, 1e-6));
}

TEST_CASE("a mesh report finds borders, flipped, third and flat triangles and unused vertices") {
  Mesh open = tetrahedron();
  open.triangles.pop_back();
  CHECK(examine(open).borderEdges == 3);
  Mesh turned = tetrahedron();
  std::swap(turned.triangles[0][1], turned.triangles[0][2]);
  CHECK(examine(turned).turnedEdges == 3);
  Mesh crowded = tetrahedron();
  crowded.vertices.positions.emplace_back(2, 2, 2);
  crowded.triangles.push_back({1, 2, 4});
  CHECK(examine(crowded).crowdedEdges == 1);
  Mesh flat = tetrahedron();
  flat.vertices.positions[3] = flat.vertices.positions[2];
  CHECK(examine(flat).flat == 2);
  Mesh lonely = tetrahedron();
  lonely.vertices.positions.emplace_back(9, 9, 9);
  CHECK(examine(lonely).unused == 1);
  CHECK(examine(lonely).euler() == 2);
  CHECK(examine(Mesh{}).closed());
}

TEST_CASE("a mesh is written and read unchanged in both encodings, in doubles if its cell requires them") {
  const ScratchFolder folder;
  for (const bool ascii : {false, true})
    for (const double far : {0.0, 1e6}) {
      CAPTURE(ascii);
      CAPTURE(far);
      Mesh mesh = tetrahedron();
      mesh.vertices.origin = DVec3(far, 0, 0);
      mesh.vertices.colors.assign(4, {10, 20, 30, 255});
      writeMesh(folder / "mesh.ply", mesh, 1.0, ascii);
      std::vector<std::array<std::uint32_t, 3>> triangles;
      const PointCloud read = readPly(folder / "mesh.ply", nullptr, {.triangles = &triangles});
      CHECK(triangles == mesh.triangles);
      REQUIRE(read.size() == 4);
      for (std::size_t i = 0; i < 4; ++i) CHECK(read.fileCoordinates(i) == mesh.vertices.fileCoordinates(i));
      CHECK(read.normals == mesh.vertices.normals);
      CHECK(read.colors[3][1] == 20);
      CHECK(read.storedAs.position == (far > 0 ? ScalarType::f64 : ScalarType::f32));
    }
}

}  // namespace palpate::mesh_test
