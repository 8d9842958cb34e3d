// Meshes: a written mesh is read again as evenly spread points of its surface, and invalid meshes are refused.
#include "engine/io/known_formats.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>

#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/mesh_import.hpp"
#include "engine/io/saving.hpp"
#include "engine/io/triangle_soup.hpp"
#include "tests/content_of.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/io/gltf_bytes.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::test::mesh_format_test {

namespace {

/// A box of 1 x 2 x 3, with faces anticlockwise seen from outside.
struct Box {
  PointCloud corners;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  Box() {
    for (unsigned k = 0; k < 8; ++k)
      corners.positions.emplace_back(k & 1 ? 1.f : 0.f, k & 2 ? 2.f : 0.f, k & 4 ? 3.f : 0.f);
    for (const auto& [a, b, c, d] : std::vector<std::array<std::uint32_t, 4>>{
             {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  }
};

/// Index of the box's face on which a point lies; -1: none.
int faceOf(const DVec3& p) {
  constexpr double kNear = 1e-5;
  const DVec3 size(1, 2, 3);
  for (int k = 0; k < 3; ++k) {
    if (std::abs(p[k]) < kNear) return 2 * k;
    if (std::abs(p[k] - size[k]) < kNear) return 2 * k + 1;
  }
  return -1;
}

void checkSamples(const PointCloud& cloud, std::size_t count) {
  REQUIRE(cloud.size() == count);
  REQUIRE(cloud.hasNormals());
  std::array<double, 6> onFace{};
  bool all = true;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const int face = faceOf(cloud.fileCoordinates(i));
    all = all && face >= 0;
    if (face < 0) continue;
    onFace[static_cast<std::size_t>(face)] += 1;
    Vec3 outwards(0);
    outwards[face / 2] = face % 2 ? 1.f : -1.f;
    const DVec3 p = cloud.fileCoordinates(i);
    const double edge = std::min({p.x, p.y, p.z, 1 - p.x, 2 - p.y, 3 - p.z, 1.0});
    if (edge < -1e-5) all = false;
    all =
        all && (glm::length(cloud.normals[i] - outwards) < 1e-5f || faceOf(p + DVec3(1e-4)) != faceOf(p - DVec3(1e-4)));
  }
  CHECK(all);
  const double areas[] = {6, 6, 3, 3, 2, 2};
  for (std::size_t k = 0; k < 6; ++k)
    CHECK(std::abs(onFace[k] - areas[k] / 22 * static_cast<double>(count)) < 4);  // two triangles, each off by one
}

std::string refusalOf(const std::filesystem::path& file) {
  return errorOf<FileError>([&] { readCloud(file); });
}

}  // namespace

TEST_CASE("a mesh is sampled evenly, with the requested number of points, the same for any number of threads") {
  const Box box;
  TriangleSoup soup{.triangles = box.triangles};
  for (const Vec3& p : box.corners.positions) soup.corners.emplace_back(p);
  for (const std::size_t count : {std::size_t{1}, std::size_t{7}, std::size_t{22'001}}) {
    const SampledSoup one = sampleSoup(soup, count, 5, 1), three = sampleSoup(soup, count, 5, 3);
    CHECK(one.cloud.size() == count);
    CHECK(one.cloud.positions == three.cloud.positions);
    CHECK(one.flat == 0);
  }
  checkSamples(sampleSoup(soup, 22'000, 5).cloud, 22'000);
  CHECK(sampleSoup(soup, 100, 5).cloud.positions != sampleSoup(soup, 100, 6).cloud.positions);
  // No gaps: on the largest face, every cell of a grid has about its share.
  const PointCloud cloud = sampleSoup(soup, 22'000, 5).cloud;
  std::array<int, 150> cells{};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const DVec3 p = cloud.fileCoordinates(i);
    if (std::abs(p.x) > 1e-5) continue;
    const auto cell =
        static_cast<std::size_t>(std::min(p.y * 5, 9.0)) * 15 + static_cast<std::size_t>(std::min(p.z * 5, 14.0));
    ++cells[cell];
  }
  const auto [least, most] = std::ranges::minmax(cells);
  CHECK(least >= 32);  // of 40; random sampling would leave some with 25
  CHECK(most <= 48);
}

TEST_CASE("degenerate triangles and those with non-finite corners are left out and counted") {
  TriangleSoup soup{.corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {std::nan(""), 0, 0}, {1e300, 0, 0}},
                    .triangles = {{0, 1, 3}, {0, 1, 2}, {0, 0, 0}, {0, 1, 4}, {0, 2, 5}}};
  const SampledSoup sampled = sampleSoup(soup, 500, 1);
  CHECK(sampled.flat == 4);
  REQUIRE(sampled.cloud.size() == 500);
  for (const Vec3& p : sampled.cloud.positions) CHECK((p.x >= 0 && p.y >= 0 && p.x + p.y <= 1.0001f && p.z == 0));
  soup.triangles = {{0, 1, 3}};
  CHECK(sampleSoup(soup, 500, 1).cloud.empty());
  CHECK(sampleSoup({}, 500, 1).cloud.empty());
}

TEST_CASE("normals and colours of corners are interpolated over their triangle") {
  const TriangleSoup soup{.corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                          .normals = {{1, 0, 1}, {0, 0, 2}, {0, 0, 1}},
                          .colors = {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}},
                          .triangles = {{0, 1, 2}}};
  const PointCloud cloud = sampleSoup(soup, 1000, 3).cloud;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const DVec3 p = cloud.fileCoordinates(i), shares(1 - p.x - p.y, p.x, p.y);
    const DVec3 normal =
        glm::normalize(shares.x * DVec3(1, 0, 1) + shares.y * DVec3(0, 0, 2) + shares.z * DVec3(0, 0, 1));
    CHECK(glm::length(DVec3(cloud.normals[i]) - normal) < 1e-5);
    for (int k = 0; k < 3; ++k) CHECK(std::abs(cloud.colors[i][static_cast<std::size_t>(k)] - 255 * shares[k]) < 0.51);
  }
}

TEST_CASE("OBJ, STL and OFF are read again as points of the same surface") {
  const ScratchFolder folder;
  const Box box;
  for (const char* name : {"a.obj", "a.stl", "a.off"})
    for (const bool ascii : {false, true}) {
      CAPTURE(std::string(name));
      writeCloud(folder / name, box.corners, {.ascii = ascii, .triangles = &box.triangles});
      const StoredCloud stored = readCloud(folder / name, nullptr, {.samples = 4400});
      checkSamples(stored.cloud, 4400);
      CHECK(stored.lost == std::vector<std::string>{"12 triangles, of which the points are samples"});
      CHECK(contentsOf(folder / name).madeFrom == "12 triangles");
      CHECK(readCloud(folder / name).cloud.size() == kUsualSamples);
    }
}

TEST_CASE("OBJ keeps normals and colours of corners, and coordinates far from zero") {
  const ScratchFolder folder;
  Box box;
  for (std::size_t k = 0; k < 8; ++k) {
    box.corners.colors.push_back({200, 100, 50, 255});
    box.corners.normals.emplace_back(0, 0, 1);
  }
  writeCloud(folder / "a.obj", box.corners, {.triangles = &box.triangles});
  const PointCloud cloud = readCloud(folder / "a.obj", nullptr, {.samples = 100}).cloud;
  REQUIRE(cloud.hasColors());
  CHECK(cloud.colors[7] == std::array<std::uint8_t, 4>{200, 100, 50, 255});
  CHECK(glm::length(cloud.normals[7] - Vec3(0, 0, 1)) < 1e-6f);
  CHECK(faceOf(DVec3(cloud.positions[3]) + cloud.origin) >= 0);
  const PointCloud flat = readCloud(folder / "a.obj", nullptr, {.normalsFromFaces = true, .samples = 100}).cloud;
  CHECK(std::ranges::any_of(flat.normals, [](const Vec3& n) { return std::abs(n.z) < 0.5f; }));
  box.corners.origin = {400000, 5000000, 0};
  writeCloud(folder / "far.obj", box.corners, {.triangles = &box.triangles});
  std::ifstream file(folder / "far.obj");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  CHECK(text.find("v 400001 5000002 3") != std::string::npos);
}

TEST_CASE("glTF meshes are placed by their nodes, and have y up") {
  const ScratchFolder folder;
  std::string glb = gltfTriangle(true);
  std::ofstream(folder / "a.glb", std::ios::binary) << glb;
  const PointCloud cloud = readCloud(folder / "a.glb", nullptr, {.samples = 300}).cloud;
  REQUIRE(cloud.size() == 300);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const DVec3 p = (cloud.fileCoordinates(i) - DVec3(10, 20, 30)) / 2.0;
    CHECK((p.x > -1e-5 && p.y > -1e-5 && p.x + p.y < 1 + 1e-5 && std::abs(p.z) < 1e-5));
    CHECK(glm::length(cloud.normals[i] - Vec3(0, 0, 1)) < 1e-6f);
  }
  CHECK(std::ranges::count(cloud.storedAs.comments, "comment up: y") == 1);
  std::ofstream(folder / "lies.glb", std::ios::binary) << glb.replace(8, 4, "\xff\xff\xff\x7f");
  CHECK(refusalOf(folder / "lies.glb") != "");
}

TEST_CASE("files without a mesh or triangles are refused with their name") {
  const ScratchFolder folder;
  const auto with = [&](const char* name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
    return refusalOf(folder / name);
  };
  for (const char* name : {"a.obj", "a.stl", "a.off", "a.gltf", "a.glb"}) {
    CAPTURE(std::string(name));
    CHECK(with(name, "no mesh at all, but some words").find(name) != std::string::npos);
    CHECK(with(name, "").find(name) != std::string::npos);
    CHECK(with(name, "no mesh at all, but some words") != "read");
  }
  CHECK(refusalOf(folder / "none.obj") != "read");
  CHECK(with("empty.obj", "# nothing\no a\n") != "read");
  CHECK(with("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").find("none of its 1 triangle has an area") !=
        std::string::npos);
  CHECK(with("beyond.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n") != "read");
}

TEST_CASE("mesh formats require triangles, and a sculpted cloud of a mesh file is saved as PLY points") {
  const ScratchFolder folder;
  const Box box;
  CHECK_THROWS_WITH_AS(objFormat().write(folder / "a.obj", box.corners, {}), doctest::Contains("there are none"),
                       FileError);
  CHECK_FALSE(std::filesystem::exists(folder / "a.obj"));
  CHECK(cloudFormats().toSave("a.obj").name == "PLY");
  CHECK(cloudFormats().toSave("a.obj", true).name == "OBJ");
  CHECK(whereToSave(folder / "a.obj") == folder / "a-sculpted.ply");
  CHECK(whereToSave(folder / "a.e57") == folder / "a-sculpted.ply");
  CHECK(whereToSave(folder / "a.laz") == folder / "a.laz");
  StoredCloud stored{.cloud = box.corners, .triangles = box.triangles};
  stored.cloud.colors.resize(8);
  stored.cloud.extra.push_back({"heat", ScalarType::f32, std::vector<std::byte>(32)});
  CHECK(stlFormat().lacks(stored.cloud) == std::vector<std::string>{"colours", "the attribute 'heat'"});
  CHECK(objFormat().lacks(stored.cloud) == std::vector<std::string>{"the attribute 'heat'"});
}

TEST_CASE("a mesh read as triangles keeps its corners, from any mesh format into any other") {
  const ScratchFolder folder;
  Box box;
  for (Vec3& corner : box.corners.positions) corner *= 0.1f;
  for (const char* from : {"a.obj", "a.stl", "a.off"})
    for (const char* to : {"b.obj", "b.stl", "b.off", "b.ply"}) {
      CAPTURE(std::string(from));
      CAPTURE(std::string(to));
      writeCloud(folder / from, box.corners, {.triangles = &box.triangles});
      const StoredCloud mesh = readCloud(folder / from, nullptr, {.asTriangles = true});
      writeCloud(folder / to, mesh.cloud, {.triangles = &mesh.triangles});
      const StoredCloud again = readCloud(folder / to, nullptr, {.asTriangles = true});
      CHECK(again.cloud.origin == DVec3(0));
      CHECK(stlFormat().lacks(mesh.cloud).empty());
      REQUIRE(again.triangles.size() == 12);
      for (std::size_t t = 0; t < 12; ++t)
        for (std::size_t k = 0; k < 3; ++k)
          CHECK(again.cloud.positions[again.triangles[t][k]] == box.corners.positions[box.triangles[t][k]]);
    }
  const PointCloud facing = readCloud(folder / "a.obj", nullptr, {.normalsFromFaces = true, .asTriangles = true}).cloud;
  REQUIRE(facing.hasNormals());
  for (std::size_t i = 0; i < 8; ++i)  // outwards from the centre of the box
    CHECK(glm::dot(facing.normals[i], box.corners.positions[i] - 0.1f * Vec3(0.5f, 1, 1.5f)) > 0);
  // Double precision where the corners need it, and no message about lost precision where they do not.
  std::ofstream(folder / "far.off") << "OFF\n3 1 0\n5000000.125 0 0\n5000001.001 0 0\n5000000 1 0\n3 0 1 2\n";
  const StoredCloud far = readCloud(folder / "far.off", nullptr, {.asTriangles = true});
  CHECK(far.cloud.fileCoordinates(1) == DVec3(5000001.001, 0, 0));
  CHECK(stlFormat().lacks(far.cloud) == std::vector<std::string>{"coordinates finer than single precision"});
  for (const char* nowhere : {"nan", "inf", "1e37"}) {
    std::ofstream(folder / "none.off") << "OFF\n3 1 0\n" << nowhere << " 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    CHECK_THROWS_WITH_AS(readCloud(folder / "none.off", nullptr, {.asTriangles = true}),
                         doctest::Contains("none.off: none of its corners has a finite position"), FileError);
  }
}

}  // namespace palpate::test::mesh_format_test
