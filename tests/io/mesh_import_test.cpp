// The readers of OBJ, STL and OFF: features of each format, meshes as other programs write them, and errors with their
// line or byte; polygons as triangles.
#include "engine/io/mesh_import.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>

#include "engine/core/error.hpp"
#include "engine/io/polygon.hpp"
#include "engine/io/triangle_mesh_file.hpp"
#include "tests/io/mesh_texts.hpp"
#include "tests/near.hpp"

namespace palpate::test::mesh_import_test {

using namespace mesh_texts;
using mesh_texts::refuses;

namespace {

double areaOf(const TriangleSoup& soup) {
  double area = 0;
  for (const auto& [a, b, c] : soup.triangles)
    area += 0.5 * glm::length(glm::cross(soup.corners[b] - soup.corners[a], soup.corners[c] - soup.corners[a]));
  return area;
}

std::string bytesOfFacet(float height, std::uint16_t mark) {
  std::string out;
  for (const float value : {0.f, 0.f, 1.f, 0.f, 0.f, height, 1.f, 0.f, height, 0.f, 1.f, height})
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  return out.append(reinterpret_cast<const char*>(&mark), sizeof mark);
}

std::string binaryStl(std::uint32_t said, const std::string& facets) {
  std::string head(80, ' ');
  head.replace(0, 5, "solid");  // as some programs begin it
  return head.append(reinterpret_cast<const char*>(&said), sizeof said) + facets;
}

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

TEST_CASE("concave polygons become triangles inside them, always two fewer than corners") {
  // A plus sign, anticlockwise and clockwise, in an inclined plane.
  std::vector<DVec3> plus;
  for (const auto& [x, y] : std::vector<std::pair<int, int>>{
           {1, 0}, {2, 0}, {2, 1}, {3, 1}, {3, 2}, {2, 2}, {2, 3}, {1, 3}, {1, 2}, {0, 2}, {0, 1}, {1, 1}})
    plus.emplace_back(x, y, x + 2 * y);
  for (const bool turned : {false, true}) {
    if (turned) std::ranges::reverse(plus);
    TriangleSoup soup{.corners = plus};
    addPolygon(plus, soup.triangles);
    CHECK(soup.triangles.size() == 10);
    CHECK(areaOf(soup) == near(5 * std::sqrt(1 + 1 + 4.0), 1e-6));  // a fan would cover more
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const std::size_t count : {0u, 2u, 3u, 5u, 400u}) {
    std::vector<DVec3> ring;
    for (std::size_t k = 0; k < count; ++k)
      ring.emplace_back(std::cos(0.01 * double(k)), std::sin(0.01 * double(k)), 0);
    triangles.clear();
    addPolygon(ring, triangles);
    CHECK(triangles.size() == std::max<std::size_t>(count, 2) - 2);
  }
  // Polygons that intersect themselves, or whose corners coincide or are not finite, give as many triangles.
  const double none = std::nan("");
  for (const std::vector<DVec3>& odd : std::vector<std::vector<DVec3>>{{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}},
                                                                       std::vector<DVec3>(7, DVec3(3)),
                                                                       std::vector<DVec3>(6, DVec3(none))}) {
    triangles.clear();
    addPolygon(odd, triangles);
    CHECK(triangles.size() == odd.size() - 2);
  }
}

TEST_CASE("OBJ: negative indices, corners with several normals, and unsupported statements are reported") {
  const ImportedMesh mesh = imported(importObj,
                                     "# by hand\nmtllib a.mtl\no one\nv 0 0 0 \nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\n"
                                     "vn 0 0 1\nvn 0 0 -2\nf 1//1 2//1 3//1 4//1\nf -1/1/-1 -2/1/-1 \\\n-3/1/-1\n"
                                     "l 1 2\np 3\nsurf 0 1 0 1 1 2\nnonsense 3\n");
  CHECK(mesh.soup.triangles.size() == 3);
  REQUIRE(mesh.soup.corners.size() == 7);  // four, and three with the other normal
  REQUIRE(mesh.soup.normals.size() == 7);
  const auto& last = mesh.soup.triangles.back();
  CHECK(mesh.soup.corners[last[0]] == DVec3(0, 1, 0));
  CHECK(mesh.soup.corners[last[2]] == DVec3(1, 0, 0));
  CHECK(mesh.soup.normals[last[1]] == Vec3(0, 0, -2));
  CHECK(mesh.lost ==
        std::vector<std::string>{"2 points and lines", "1 free-form curves and surfaces", "1 unknown statements"});
  // One face without a normal leaves all corners without normals.
  const ImportedMesh some = imported(importObj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 3 2 1\n");
  CHECK(some.soup.normals.empty());
  CHECK(some.soup.corners.size() == 3);
  CHECK(some.soup.triangles.size() == 2);
}

TEST_CASE("OBJ: comments that end with a backslash, numbers of old Windows programs and missing normals") {
  const TriangleSoup points = imported(importObj, "# C:\\scans\\\nv 0 0 0 # here \\\nv 1 0 0\nv 1 \\\n1 0\n").soup;
  REQUIRE(points.corners.size() == 3);
  CHECK(points.corners[2] == DVec3(1, 1, 0));
  const StoredCloud some =
      readingFile("a.obj", "v 1 2 3\nv -1.#IND 2 1\nv 4 5 6#here\nv 1 2 1.#QNAN\nv 1.#INF 0 0\nv 7 8 9\n");
  CHECK(some.cloud.size() == 3);
  CHECK(some.lost == std::vector<std::string>{"3 points without a finite position below 1e30"});
  // Rounded to few digits by the program that wrote them.
  CHECK(readingFile("a.obj", "v 1 2 3\nv -1.#J 2 1\nv 1 1.#R 1\nv 0 0 -1.#IO\nv -1.#IND00 0 0\n").cloud.size() == 1);
  const ImportedMesh mesh = imported(importObj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 3 2 1\n");
  CHECK(mesh.lost == std::vector<std::string>{"normals, which some corners lack"});
  for (const char* face : {"f 1// 2// 3//\n", "f 1//0 2//0 3//0\n", "f 1/0/0 2/0/0 3/0/0\n", "f 1/ 2/ 3/\n"})
    CHECK(imported(importObj, std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\n") + face).soup.triangles.size() == 1);
  const StoredCloud zero =
      readingFile("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 0\nvn nan 0 1\nf 1//1 2//2 3//1\n", {.samples = 10});
  CHECK(zero.cloud.normals.at(0) == Vec3(0, 0, 1));
  const TriangleSoup stl =
      imported(importStl,
               "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1.#INF\nvertex 1 0 0\nvertex 0 "
               "1 0\nendloop\nendfacet\nEnd Solid\n")
          .soup;
  REQUIRE(stl.corners.size() == 3);
  CHECK(std::isinf(stl.corners[0].z));
}

TEST_CASE(
    "OBJ: colours of materials and of ZBrush become those of corners, and textures without coordinates are named") {
  using Colors = std::vector<std::array<std::uint8_t, 4>>;
  const std::array<std::uint8_t, 4> red{255, 0, 0, 255}, green{0, 255, 0, 255}, white{255, 255, 255, 255};
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const ScratchFolder folder;
  const auto reading = [&](const std::string& text) {
    std::ofstream(folder / "a.obj") << text;
    return importObj(folder / "a.obj");
  };
  std::ofstream(folder / "two kinds.mtl")
      << "newmtl signal red\nKd 1 0 0\nmap_Kd -s 1 1 1 red.png\nnewmtl leaf\nKd 0 1 0\n";
  std::ofstream(folder / "grey.mtl") << "newmtl a\nKd 0.8 0.8 0.8\nnewmtl unused\nKd 1 0 0\nmap_Kd b.png\n";
  const std::string faces = "usemtl signal red\nf 1 2 3\nusemtl leaf\nf 1 3 4\n";
  const ImportedMesh mesh = reading("mtllib two kinds.mtl\n" + corners + faces);
  REQUIRE(mesh.soup.corners.size() == 6);  // a corner of each material
  CHECK(mesh.soup.colors == Colors{red, red, red, green, green, green});
  CHECK(mesh.lost == std::vector<std::string>{"the texture of 1 triangle without coordinates"});
  const ImportedMesh facing =
      reading("mtllib two kinds.mtl\nvn 0 0 1\nvn 0 1 0\n" + corners +
              "usemtl leaf\nf 1//1 2//2 3//1\nf 1//1 3//1 4//1\nusemtl none\nf 4//2 1//2 2//2\n");
  CHECK(facing.soup.corners.size() == 7);
  CHECK(facing.soup.normals.size() == 7);
  CHECK(facing.soup.colors.back() == white);
  const ImportedMesh grey = reading("mtllib grey.mtl\n" + corners + "usemtl a\nf 1 2 3\n");
  CHECK(grey.soup.colors.empty());
  CHECK(grey.lost.empty());
  CHECK(reading("mtllib gone.mtl\n" + corners + "usemtl a\nf 1 2 3\n").lost ==
        std::vector<std::string>{"the materials of 'gone.mtl', which is missing"});
  const ImportedMesh painted = reading(corners + "#MRGB ffff0000ff00ff00\n#MRGB ff00ff00ffff0000\nf 1 2 3\n");
  CHECK(painted.soup.colors == Colors{red, green, green, red});
  CHECK(reading(corners + "#MRGB ffff0000\nf 1 2 3\n").lost ==
        std::vector<std::string>{"the paint (#MRGB) of 1 of 4 corners"});
  refuses(importObj, corners + "#MRGB ffff00zz\nf 1 2 3\n", ":5: a colour of #MRGB is not hexadecimal");
}

TEST_CASE("OBJ: invalid statements are refused with their line") {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  refuses(importObj, three + "f 1 2 4\n", ":4: a face refers to corner 4, but only 3 precede it");
  refuses(importObj, three + "f 1 2 -4\n", ":4: a face refers to corner -4, but only 3 precede it");
  refuses(importObj, three + "f 0 2 1\n", ":4: a face refers to corner 0, but only 3 precede it");
  refuses(importObj, three + "f 1//1 2 3\n", ":4: a face refers to normal 1, but only 0 precede it");
  refuses(importObj, three + "f 1 2 three\n", ":4: found 'three', expected the number of corner");
  refuses(importObj, three + "f 1 2 99999999999999999999\n", ":4: found ...");
  refuses(importObj, "v 0 0\n", ":1: the line ends where a coordinate should be");
  refuses(importObj, "\nv 0 zero 0\n", ":2: found 'zero', expected a coordinate");
  refuses(importObj, "some words\n", ":1: found 'some', expected a statement of OBJ");
  refuses(importObj, "gr\xfcn\n", ":1: found 'gr?n', expected a statement of OBJ");
  for (const std::string junk : {"\x02\x8f\xff\xa1\n", "ab\x01\n"})
    refuses(importObj, junk, ":1: found bytes that are not text, expected a statement of OBJ");
}

TEST_CASE("STL: binary files are recognized by their size, whatever word they begin with") {
  const ImportedMesh binary = imported(importStl, binaryStl(2, bytesOfFacet(1, 0) + bytesOfFacet(2, 7)));
  CHECK(binary.soup.triangles.size() == 2);
  CHECK(binary.soup.corners.at(3) == DVec3(0, 0, 2));
  CHECK(binary.lost == std::vector<std::string>{"colours or marks of 1 triangle"});
  const std::string facet =
      "FACET NORMAL 0 0 1\n outer loop\n vertex 0 0 1\n VERTEX 1 0 1e0\n vertex 0 1 1\n endloop\nendfacet\n";
  const ImportedMesh text =
      imported(importStl, " solid a b\n" + facet + "endsolid\nsolid c\n" + facet + "endsolid c\n");
  CHECK(text.soup.triangles.size() == 2);
  CHECK(text.soup.corners.at(4) == DVec3(1, 0, 1));

  std::string other = binaryStl(3, bytesOfFacet(1, 0));
  other.replace(0, 5, "other");
  refuses(importStl, other, ": byte 134: the file ends after 1 of 3 triangles");
  other = binaryStl(1, bytesOfFacet(1, 0) + "x");
  other.replace(0, 5, "other");
  CHECK(imported(importStl, other).lost == std::vector<std::string>{"1 bytes after the last of 1 triangle"});
  refuses(importStl, "short", ": byte 5: the file ends within its header");
  refuses(importStl, "solid a\n" + facet, ":8: the file ends within a solid");
  refuses(importStl, "solid a\nfacet\nvertex 0 0 0\nendfacet\n", ":4: a facet of 1 corner");
  refuses(importStl, "solid a\nfacet\nvertex 0 0\n", ":3: the line ends where a coordinate should be");
  refuses(importStl, "solid a\nwords\n", ":2: found 'words', expected a keyword of STL");
}

TEST_CASE("OFF: normals and colours follow the first word, and invalid lines are refused with their line") {
  const ImportedMesh mesh = imported(importOff,
                                     "CNOFF # a square\n\n5 3 0\n0 0 0 0 0 1 255 0 0 255\n1 0 0 0 0 1 0 255 0 255\n"
                                     "1 1 0 0 0 1 0 0 255 255\n0 1 0 0 0 1 9 9 9 255\n9 9 9 0 0 1 0 0 0 0\n"
                                     "4 0 1 2 3 200 100 50\n3 0 1 2\n2 0 4\n");
  CHECK(mesh.soup.triangles.size() == 3);
  CHECK(mesh.soup.normals.size() == 5);
  REQUIRE(mesh.soup.colors.size() == 5);
  CHECK(mesh.soup.colors[3] == std::array<std::uint8_t, 4>{9, 9, 9, 255});
  CHECK(mesh.lost == std::vector<std::string>{"1 points and lines", "the colours of 1 face"});
  const ImportedMesh bare =
      imported(importOff, "3 1 3\n0 0 0 0.5 0.25 1.0\n1 0 0 0.5 0.25 1.0\n0 1 0 0.5 0.25 1.0\n3 0 1 2\n");
  REQUIRE(bare.soup.colors.size() == 3);
  CHECK(bare.soup.colors[0] == std::array<std::uint8_t, 4>{128, 64, 255, 255});
  CHECK(imported(importOff, "OFF 3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").soup.triangles.size() == 1);

  const std::string three = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
  refuses(importOff, three, ":5: the file ends after 0 of 1 faces");
  refuses(importOff, "OFF\n4000000000 1 0\n0 0 0\n", ":3: the file ends after 1 of 4000000000 corners");
  refuses(importOff, three + "3 0 1 3\n", ":6: a face refers to corner 3, counted from 0, but there are only 3");
  refuses(importOff, three + "4000000000 0 1 2\n", ":6: the line ends where the number of a corner should be");
  refuses(importOff, three + "3 0 1 2\n3 0 1 2\n", ":7: unexpected data after the last of 1 face");
  refuses(importOff, "4OFF\n", ":1: OFF with the prefix '4' is not read; only C and N are");
  refuses(importOff, "OFF BINARY\n", "...binary OFF...");
  refuses(importOff, "words\n", ":1: found 'words', expected OFF");
}

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

}  // namespace palpate::test::mesh_import_test
