#include "engine/cloud/edited_cloud.hpp"

#include <doctest/doctest.h>

#include "engine/core/error.hpp"
#include "engine/io/ply_reader.hpp"
#include "engine/io/ply_writer.hpp"
#include "tests/content_of.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::edited_cloud_test {

namespace {

// Far from the origin, with optional properties of files.
PointCloud richCloud() {
  PointCloud cloud;
  cloud.origin = {1e6, -2e6, 0};
  cloud.storedAs.position = ScalarType::f64;
  cloud.storedAs.comments = {"comment scanned by hand"};
  Attribute quality{.name = "quality", .type = ScalarType::i16, .data = {}};
  for (int i = 0; i < 100; ++i) {
    cloud.exactPositions.emplace_back(1e6 + 0.1 * i, -2e6 + 1e-7 * i, i / 3.0);
    cloud.positions.emplace_back(cloud.exactPositions.back() - cloud.origin);
    cloud.normals.emplace_back(0, 0, 1);
    const auto value = static_cast<std::int16_t>(1000 + i);
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    quality.data.insert(quality.data.end(), bytes, bytes + 2);
  }
  cloud.extra.push_back(quality);
  return cloud;
}

std::int16_t qualityOf(const PointCloud& cloud, std::size_t i) {
  return loadScalar<std::int16_t>(cloud.extra[0].data.data() + 2 * i);
}

}  // namespace

TEST_CASE("an unchanged cloud is written byte by byte as it was read") {
  const ScratchFolder folder;
  const PointCloud cloud = richCloud();
  auto points = statesOf(cloud);
  points.push_back({.gone = true, .number = 100, .parent = 5});  // inserted and removed again
  CHECK(changedPoints(cloud, points) == 0);
  writePly(folder / "a.ply", cloud);
  writePly(folder / "b.ply", editedCloud(cloud, points));
  CHECK(contentOf(folder / "a.ply") == contentOf(folder / "b.ply"));
}

TEST_CASE("removed points are left out, and new ones are appended with their parents' properties") {
  const PointCloud cloud = richCloud();
  auto points = statesOf(cloud);
  points[3].gone = true;
  points[7].position.z += 1;
  points.push_back({.position = {1, 2, 3}, .number = 100, .normal = {1, 0, 0}, .parent = 3});
  points.push_back({.position = {4, 5, 6}, .gone = true, .number = 101, .parent = 50});
  points.push_back({.position = {7, 8, 9}, .number = 102, .normal = {0, 1, 0}, .parent = 101});
  CHECK(changedPoints(cloud, points) == 4);
  const PointCloud edited = editedCloud(cloud, points);
  REQUIRE(edited.size() == 101);
  CHECK(qualityOf(edited, 2) == 1002);
  CHECK(qualityOf(edited, 3) == 1004);
  CHECK(edited.fileCoordinates(3) == cloud.exactPositions[4]);
  CHECK(edited.fileCoordinates(6) == cloud.origin + DVec3(points[7].position));
  CHECK(edited.normals[99] == Vec3(1, 0, 0));
  CHECK(edited.fileCoordinates(99) == cloud.origin + DVec3(1, 2, 3));
  CHECK(qualityOf(edited, 99) == 1003);   // the parent is removed, its properties remain
  CHECK(qualityOf(edited, 100) == 1050);  // the parent's parent
  CHECK(edited.storedAs.comments == cloud.storedAs.comments);
  CHECK_FALSE(edited.hasColors());
}

TEST_CASE("paint on a cloud without colours adds colours; on one with colours it replaces them") {
  PointCloud cloud = richCloud();
  auto points = statesOf(cloud);
  points[1].color = 0xFF0000FFu;
  CHECK(changedPoints(cloud, points) == 1);
  const PointCloud painted = editedCloud(cloud, points);
  REQUIRE(painted.hasColors());
  CHECK(painted.colors[0] == kUnpainted);
  CHECK(painted.colors[1] == std::array<std::uint8_t, 4>{255, 0, 0, 255});

  cloud.colors.assign(cloud.size(), {1, 2, 3, 4});
  points = statesOf(cloud);
  points[5].color = 0;
  const PointCloud again = editedCloud(cloud, points);
  CHECK(again.colors[4] == std::array<std::uint8_t, 4>{1, 2, 3, 4});
  CHECK(again.colors[5] == std::array<std::uint8_t, 4>{0, 0, 0, 0});
}

TEST_CASE("a cloud without remaining points is written and read") {
  const ScratchFolder folder;
  const PointCloud cloud = richCloud();
  auto points = statesOf(cloud);
  for (PointState& point : points) point.gone = true;
  CHECK(changedPoints(cloud, points) == 100);
  writePly(folder / "none.ply", editedCloud(cloud, points));
  CHECK(readPly(folder / "none.ply").empty());
}

}  // namespace palpate::edited_cloud_test
