// The unit of length of a LAS file, from its coordinate system, and what becomes of it.
#include <doctest/doctest.h>

#include "engine/cloud/length_unit.hpp"
#include "engine/io/las_format.hpp"
#include "tests/io/las_points.hpp"

namespace palpate::test::las_unit_test {

namespace {

constexpr const char* kUser = "LASF_Projection";

// One point, with a record before the points or behind them.
std::string fileWith(const std::string& records, std::uint32_t count, const std::string& behind = "") {
  test::LasBytes file{.minor = behind.empty() ? 2u : 4u, .records = records, .recordCount = count};
  file.points.assign(20, '\0');
  file.count = 1;
  file.tail = behind;
  file.longRecords = behind.empty() ? 0 : 1;
  return file.text();
}

LengthUnit unitOf(const std::string& file) { return unitSaidIn(test::reading(file).cloud.storedAs.comments); }

LengthUnit ofText(const std::string& text) { return unitOf(fileWith(test::lasRecord(kUser, 2112, text), 1)); }

LengthUnit ofKeys(const std::vector<std::array<std::uint16_t, 2>>& keys, const std::string& names = "") {
  std::string data;
  test::putAt(data, 6, static_cast<std::uint16_t>(keys.size()));
  for (const auto& [key, value] : keys) {
    const std::size_t at = data.size();
    test::putAt(data, at, key);
    test::putAt(data, at + 4, std::uint16_t{1});
    test::putAt(data, at + 6, value);
  }
  const std::string records = test::lasRecord(kUser, 34735, data) + test::lasRecord(kUser, 34737, names);
  return unitOf(fileWith(records, 2));
}

constexpr const char* kFeet =
    "PROJCS[\"NAD83 / Texas Central (ftUS)\",GEOGCS[\"NAD83\",DATUM[\"D\",SPHEROID[\"GRS 1980\",6378137,298.25]],"
    "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Lambert\"],"
    "PARAMETER[\"false_easting\",2296583.333],UNIT[\"US survey foot\",0.304800609601219],AXIS[\"X\",EAST]]";

}  // namespace

TEST_CASE("a LAS file has the unit of its coordinate system, and none if that is in degrees or missing") {
  CHECK(unitOf(fileWith("", 0)) == LengthUnit::unknown);
  CHECK(ofText(kFeet) == LengthUnit::foot);
  CHECK(ofText(std::string("COMPD_CS[\"c\",") + kFeet + ",VERT_CS[\"h\",UNIT[\"metre\",1.0]]]") == LengthUnit::foot);
  CHECK(ofText("PROJCS[\"UTM\",GEOGCS[\"W\",UNIT[\"degree\",0.0174532925199433]],UNIT[\"metre\",1]]") == LengthUnit::m);
  CHECK(ofText("PROJCS[\"n\",UNIT[\"US survey foot\",0.3048006],VERTCS[\"h\",UNIT[\"US survey foot\",1.0]]]") ==
        LengthUnit::foot);
  CHECK(ofText("GEOGCS[\"WGS 84\",UNIT[\"degree\",0.0174532925199433]]") == LengthUnit::unknown);
  CHECK(ofText("PROJCRS[\"n\",CONVERSION[\"c\",PARAMETER[\"e\",1,LENGTHUNIT[\"metre\",1]]],CS[Cartesian,2],"
               "AXIS[\"x\",east],LENGTHUNIT[\"foot\", 0.3048]]") == LengthUnit::foot);
  CHECK(ofText("PROJCS[\"n\",UNIT[\"fathom\",1.8288]]") == LengthUnit::unknown);
  CHECK(ofText("PROJCS[\"cut off\",UNIT[\"") == LengthUnit::m);
  CHECK(ofKeys({{1024, 1}, {3076, 9001}}) == LengthUnit::m);
  CHECK(ofKeys({{1024, 1}, {3072, 2277}, {3076, 9003}}) == LengthUnit::foot);
  CHECK(ofKeys({{1024, 1}, {3076, 9002}}) == LengthUnit::foot);
  CHECK(ofKeys({{1024, 1}, {3076, 9014}}) == LengthUnit::unknown);
  CHECK(ofKeys({{1024, 2}, {2048, 4326}}) == LengthUnit::unknown);
  CHECK(ofKeys({{1024, 1}, {3072, 2277}}) == LengthUnit::foot);  // a state plane
  CHECK(ofKeys({{1024, 1}, {3072, 32633}}) == LengthUnit::m);
  CHECK(ofKeys({{1024, 1}, {3072, 6588}}, "NAD83(2011) / Texas South Central (ftUS)|") == LengthUnit::foot);
  // Behind the points, as LAS 1.4 allows.
  CHECK(unitOf(fileWith("", 0, test::lasLongRecord(kUser, 2112, kFeet))) == LengthUnit::foot);
}

TEST_CASE("the unit of a LAS file is written back unchanged, and to other formats as a comment") {
  for (const std::string& file : {fileWith("", 0), fileWith(test::lasRecord(kUser, 2112, kFeet), 1),
                                  fileWith("", 0, test::lasLongRecord(kUser, 2112, kFeet))}) {
    const std::string once = test::again(file);
    CHECK(once.find("comment units") == std::string::npos);
    CHECK(test::again(once) == once);
    CHECK(unitOf(once) == unitOf(file));
  }
  for (const LengthUnit unit : {LengthUnit::foot, LengthUnit::m}) {
    PointCloud cloud;
    cloud.positions = {{1, 2, 3}};
    sayUnit(cloud.storedAs.comments, unit);
    CHECK(unitOf(test::written(cloud)) == unit);
  }
  const PointCloud scanned = test::reading(fileWith(test::lasRecord(kUser, 2112, kFeet), 1)).cloud;
  CHECK(test::written(scanned, ".ply").find("comment units: ft\n") != std::string::npos);
}

}  // namespace palpate::test::las_unit_test
