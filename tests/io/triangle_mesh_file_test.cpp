#include "engine/io/triangle_mesh_file.hpp"

#include <doctest/doctest.h>

#include <fstream>

#include "engine/core/error.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::test::triangle_mesh_file_test {

TEST_CASE("a triangle mesh is read from files with faces; one without faces is refused") {
  const ScratchFolder folder;
  const auto file = folder / "mesh.ply";
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\n";
  const std::string places = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  std::ofstream(file) << head << "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                      << places << "4 0 1 2 3\n";
  const TriangleMesh square = readTriangleMesh(file);
  CHECK(square.triangleCount() == 2);
  CHECK(square.signedDistance({0.25, 0.5, 2}) == near(2, 1e-6));
  CHECK(square.signedDistance({0.25, 0.5, -2}) == near(-2, 1e-6));
  const auto off = folder / "mesh.off";
  std::ofstream(off) << "OFF\n4 1 0\n" << places << "4 0 1 2 3\n";
  CHECK(readTriangleMesh(off).triangleCount() == 2);
  std::ofstream(file) << head << "end_header\n" << places;
  CHECK_THROWS_AS(readTriangleMesh(file), FileError);
}

}  // namespace palpate::test::triangle_mesh_file_test
