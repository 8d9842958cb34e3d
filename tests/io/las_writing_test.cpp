// Writing LAS: unchanged points are written byte by byte, and unavoidable changes are defined.
#include "engine/io/las_format.hpp"

#include <doctest/doctest.h>

#include "engine/io/saving.hpp"
#include "tests/io/las_points.hpp"

namespace palpate::test::las_writing_test {

TEST_CASE("every LAS point format is read as specified, and written back byte by byte") {
  for (unsigned format = 0; format < kPlaces.size(); ++format) {
    CAPTURE(format);
    const std::string text = fileOf(format, 20).text();
    const StoredCloud stored = reading(text);
    REQUIRE(stored.cloud.size() == 20);
    CHECK(stored.lost.empty());
    for (std::size_t i = 0; i < 20; i += 19) checkPoint(stored.cloud, format, i);
    const std::string back = written(stored.cloud);
    CHECK(back.size() == text.size());
    CHECK(pointsOf(back) == pointsOf(text));
    CHECK(again(back) == back);
  }
}

TEST_CASE("LAS coordinates survive a conversion to PLY or text and back to LAS, bit by bit") {
  const std::string text = fileOf(3, 300).text();
  const StoredCloud stored = reading(text);
  for (const char* name : {"a.ply", "a.xyz"}) {
    const ScratchFolder folder;
    writeCloud(folder / name, stored.cloud);
    const PointCloud back = readCloud(folder / name).cloud;
    REQUIRE(back.size() == stored.cloud.size());
    // In text they are the doubles next to their decimals.
    const double beside = std::string_view(name) == "a.ply" ? 0 : 1e-15;
    for (std::size_t i = 0; i < back.size(); ++i) {
      const DVec3 one = back.fileCoordinates(i), other = stored.cloud.fileCoordinates(i);
      for (int axis = 0; axis < 3; ++axis) CHECK(std::abs(one[axis] - other[axis]) <= beside * std::abs(other[axis]));
    }
    CHECK(back.colors == stored.cloud.colors);
    CHECK(valueOf(back, "gps_time", 5) == valueOf(stored.cloud, "gps_time", 5));
    const PointCloud third = reading(written(back)).cloud;  // LAS again, without the header of the first file
    for (std::size_t i = 0; i < back.size(); ++i) CHECK(third.fileCoordinates(i) == stored.cloud.fileCoordinates(i));
    CHECK(pointsOf(written(back)) == pointsOf(text));
  }
}

TEST_CASE("LAS records before and behind the points are kept, and listed when another format loses them") {
  LasBytes las = fileOf(6, 30);
  las.records = lasRecord("LASF_Projection", 2112, "GEOGCS[...]") + lasRecord("somebody", 7, std::string(300, '\x7f'));
  las.recordCount = 2;
  las.padding = "\xdd\xcc";
  las.tail = lasLongRecord("LASF_Projection", 2112, "more of it") + lasLongRecord("late", 9, std::string(70000, 'e'));
  las.longRecords = 2;
  const StoredCloud stored = reading(las.text());
  const std::string text = las.text(), back = written(stored.cloud);
  CHECK(back.size() == text.size());
  CHECK(back.substr(375) == text.substr(375));
  CHECK(back.substr(235, 12) == text.substr(235, 12));
  const std::string sentence =
      "4 records of LAS: 'LASF_Projection' 2112, 'somebody' 7, 'LASF_Projection' 2112, 'late' 9";
  CHECK(lostOnTheWay(stored, cloudFormats().toWrite("a.ply")) == std::vector<std::string>{sentence});
  CHECK(lostOnTheWay(stored, cloudFormats().toWrite("a.las")).empty());

  // An additional attribute moves the records behind the points, and their offsets are updated.
  PointCloud more = stored.cloud;
  more.extra.push_back({"quality", ScalarType::f32, std::vector<std::byte>(4 * more.size(), std::byte{1})});
  const std::string longer = written(more);
  const StoredCloud third = reading(longer);
  CHECK(namesOf(third.cloud).back() == "quality");
  CHECK(third.cloud.extra.back().data == more.extra.back().data);
  CHECK(longer.ends_with(las.tail));
  CHECK(third.cloud.storedAs.baggage->sentence == sentence);
}

TEST_CASE("clouds of other formats are written to LAS without a change, or the change is reported") {
  PointCloud cloud;
  for (int i = 0; i < 700; ++i) {
    cloud.positions.emplace_back(0.25f * static_cast<float>(i), -1.5f, 3);
    cloud.normals.emplace_back(0, i % 2 ? 1 : -1, 0);
    cloud.colors.push_back({static_cast<std::uint8_t>(i), 2, 3, 255});
  }
  const auto attribute = [&](const char* name, auto value) {
    Attribute& added = cloud.extra.emplace_back(Attribute{name, ScalarType::f64, {}});
    for (int i = 0; i < 700; ++i) {
      const double number = value(i);
      const auto* bytes = reinterpret_cast<const std::byte*>(&number);
      added.data.insert(added.data.end(), bytes, bytes + sizeof number);
    }
  };
  attribute("intensity", [](int i) { return 0.5 + i; });  // not an integer, so not LAS's own field
  attribute("classification", [](int i) { return i % 3; });
  attribute("gps_time", [](int i) { return i * 1e-3; });
  cloud.storedAs.comments = {"comment units: mm"};
  markAsOurs(cloud);
  CHECK(lasFormat().lacks({.cloud = cloud}).empty());
  const PointCloud back = reading(written(cloud)).cloud;
  REQUIRE(back.size() == cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) CHECK(back.fileCoordinates(i) == cloud.fileCoordinates(i));
  CHECK(back.normals == cloud.normals);
  CHECK(back.colors == cloud.colors);
  CHECK(valueOf(back, "intensity", 3) == 3.5);
  CHECK(valueOf(back, "classification", 5) == 2);
  CHECK(valueOf(back, "gps_time", 5) == 5 * 1e-3);
  CHECK(isOurs(back.storedAs.comments));
  CHECK(std::ranges::find(back.storedAs.comments, "comment units: mm") != back.storedAs.comments.end());
  CHECK(std::ranges::find(back.storedAs.comments, "comment up: z") != back.storedAs.comments.end());

  StoredCloud rough{.cloud = {}, .triangles = {{0, 0, 0}}, .lost = {}};
  rough.cloud.positions = {{0.1f, 1e-9f, 0}, {1, 2, 3}};
  rough.cloud.storedAs.alpha = true;
  const std::vector<std::string> lost = lasFormat().lacks(rough);
  REQUIRE(lost.size() == 3);
  CHECK(lost[0] == "1 triangle");
  CHECK(lost[1] == "the alpha of colours");
  CHECK(lost[2].starts_with("coordinates finer than "));
  const PointCloud roughBack = reading(written(rough.cloud)).cloud;
  for (std::size_t i = 0; i < 2; ++i)
    CHECK(glm::length(roughBack.fileCoordinates(i) - rough.cloud.fileCoordinates(i)) < 3e-9);
  CHECK(reading(written({})).cloud.empty());
}

TEST_CASE("moved points are written to LAS finer than the file's step, and the others unchanged") {
  PointCloud cloud = reading(fileOf(0, 100).text()).cloud;
  const DVec3 still = cloud.fileCoordinates(41);
  cloud.positions[40] += Vec3(0.001f, -0.0004f, 0.0002f);  // the file's step is 0.01
  const DVec3 moved = cloud.fileCoordinates(40);
  const PointCloud back = reading(written(cloud)).cloud;
  CHECK(back.fileCoordinates(41) == still);
  CHECK(glm::length(back.fileCoordinates(40) - moved) < 1e-6);
}

TEST_CASE("a class or return number beyond the old LAS point formats selects a newer one") {
  PointCloud cloud = reading(fileOf(1, 10).text()).cloud;
  for (Attribute& attribute : cloud.extra)
    if (attribute.name == "classification") attribute.data[3] = std::byte{64};
  const std::string text = written(cloud);
  CHECK(static_cast<int>(text[104]) == 6);
  CHECK(static_cast<int>(text[25]) == 4);
  const PointCloud back = reading(text).cloud;
  CHECK(valueOf(back, "classification", 3) == 64);
  CHECK(valueOf(back, "classification", 4) == 6);
  CHECK(valueOf(back, "scan_angle_rank", 4) == -12);  // newer formats store it in another unit
}

TEST_CASE("a fractional intensity keeps its name through LAS and LAZ") {
  const ScratchFolder folder;
  std::ofstream(folder / "a.xyz") << "x y z intensity\n0 0 0 0.25\n1 0 0 0.5\n";
  StoredCloud stored = readCloud(folder / "a.xyz");
  for (const char* name : {"b.las", "c.laz"}) {
    writeCloud(folder / name, stored.cloud);
    stored = readCloud(folder / name);
    REQUIRE(stored.cloud.extra.size() == 1);
    CHECK(stored.cloud.extra[0].name == "intensity");
    CHECK(loadScalar<double>(stored.cloud.extra[0].data.data()) == 0.25);
  }
}

}  // namespace palpate::test::las_writing_test
