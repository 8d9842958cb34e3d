// Writing LAZ: packed and unpacked, LAS is unchanged.
#include <doctest/doctest.h>

#include "engine/core/checksum.hpp"
#include "engine/io/saving.hpp"
#include "tests/io/laz_bytes.hpp"

namespace palpate::test::laz_writing_test {

TEST_CASE("LAS converted to LAZ and back equals LAS written directly, byte by byte") {
  for (const unsigned format : {0u, 1u, 2u, 3u, 6u, 7u, 8u})
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{3000}}) {
      CAPTURE(format);
      CAPTURE(count);
      LasBytes las = variedFile(format, count, 2);
      las.records = lasRecord("LASF_Projection", 2112, "GEOGCS[...]") + lasRecord("somebody", 7, std::string(300, 'x'));
      las.recordCount = 2;
      las.padding = "\xdd\xcc";
      las.tail = las.minor == 4 ? lasLongRecord("late", 9, std::string(7000, 'e')) : "bytes that nobody knows";
      las.longRecords = las.minor == 4 ? 1 : 0;
      const StoredCloud stored = reading(las.text());
      const std::string packed = written(stored.cloud, ".laz");
      CHECK(cloudFormats().toWrite("a.laz").lacks(stored).empty());
      CHECK(lostOnTheWay(stored, cloudFormats().toWrite("a.laz")).empty());
      CHECK((static_cast<unsigned>(packed[104]) & 0x80u) != 0);
      const StoredCloud back = reading(packed);
      CHECK(back.lost.empty());
      CHECK(written(back.cloud) == written(stored.cloud));
      CHECK(written(back.cloud, ".laz") == packed);
    }
}

TEST_CASE("a packed LAZ file has exactly LASzip's length and bytes") {
  const std::filesystem::path folder = scannedFiles();
  if (folder.empty()) return;
  const std::string ours = written(readCloud(folder / "simple.las").cloud, ".laz");
  CHECK(pointsOf(ours) == pointsOf(bytesOf(folder / "simple.laz")));
}

TEST_CASE("packed LAZ bytes equal those that laz-perf has unpacked to the same points") {
  struct Truth {
    unsigned format;
    std::uint64_t packed;  // checksum of a file that laz-perf 0.0.7 has unpacked
  };
  for (const Truth& truth :
       {Truth{0u, 0xbdfa066c16c40435u}, Truth{1u, 0x280aa535c3f30b15u}, Truth{2u, 0x41a5fdd7f7230fe8u},
        Truth{3u, 0xb8eb8dad828fbd1au}, Truth{6u, 0xd5471b56cf343532u}, Truth{7u, 0xff3de9728cfb143cu},
        Truth{8u, 0x2f71ec8c07f28216u}}) {
    CAPTURE(truth.format);
    Checksum sum;
    const std::string body = pointsOf(packedFile(variedFile(truth.format, 3000, 3)));
    sum.add(std::as_bytes(std::span(body)));
    CHECK(sum.value() == truth.packed);
  }
}

TEST_CASE("a cloud of another format is packed as LAZ with the same points") {
  PointCloud cloud;
  for (int i = 0; i < 60'000; ++i) {
    cloud.positions.emplace_back(0.25f * static_cast<float>(i % 251), -1.5f, 0.5f * static_cast<float>(i / 251));
    cloud.normals.emplace_back(0, i % 2 ? 1 : -1, 0);
  }
  const PointCloud back = reading(written(cloud, ".laz")).cloud;
  REQUIRE(back.size() == cloud.size());
  CHECK(back.normals == cloud.normals);
  bool same = true;
  for (std::size_t i = 0; i < cloud.size(); ++i) same = same && back.fileCoordinates(i) == cloud.fileCoordinates(i);
  CHECK(same);
}

TEST_CASE("wave packets are refused for LAZ, and an older file is kept") {
  const ScratchFolder folder;
  const StoredCloud stored = reading(fileOf(4, 20).text());
  std::ofstream(folder / "a.laz") << "an older file";
  CHECK_THROWS_WITH_AS(writeCloud(folder / "a.laz", stored.cloud), doctest::Contains("wave packets cannot be packed"),
                       FileError);
  CHECK(bytesOf(folder / "a.laz") == "an older file");
}

}  // namespace palpate::test::laz_writing_test
