// LAZ and COPC: points are unpacked bit by bit, LAS is packed and unpacked without a change, the pages of an octree are
// traversed, and damaged or inconsistent files are refused.
#include <doctest/doctest.h>

#include "engine/core/checksum.hpp"
#include "engine/io/copc.hpp"
#include "engine/io/saving.hpp"
#include "tests/io/copc_bytes.hpp"
#include "tests/io/laz_bytes.hpp"

namespace palpate::test::laz_format_test {

namespace {

std::string rowsOf(const std::string& text) { return pointsOf(written(reading(text).cloud)); }

std::uint64_t checksumOf(const std::string& bytes) {
  Checksum sum;
  sum.add(std::as_bytes(std::span(bytes)));
  return sum.value();
}

}  // namespace

TEST_CASE("points of every packed LAZ format are unpacked bit by bit") {
  for (const unsigned format : {0u, 1u, 2u, 3u, 6u, 7u, 8u})
    for (const unsigned more : {0u, 3u})
      for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{4000}}) {
        CAPTURE(format);
        CAPTURE(more);
        CAPTURE(count);
        const LasBytes las = variedFile(format, count, more);
        const std::string rows = rowsOf(packedFile(las));
        CHECK(rows.size() == las.points.size());
        CHECK(rows == las.points);
      }
}

TEST_CASE("LAZ chunks may have any number of points, and their table may be anywhere") {
  const LasBytes las = variedFile(3, 3000), layered = variedFile(7, 3000);
  CHECK(rowsOf(packedFile(las, {.chunks = {1, 999, 1, 1500, 499}})) == las.points);
  CHECK(rowsOf(packedFile(layered, {.chunks = {1, 999, 1, 1500, 499}})) == layered.points);
  CHECK(rowsOf(packedFile(las, {.chunked = false})) == las.points);
  CHECK(rowsOf(packedFile(las, {.tableAtEnd = true})) == las.points);
  CHECK(rowsOf(packedFile(layered, {.version4 = true})) == layered.points);
  const std::string none = packedFile(variedFile(1, 0));
  CHECK(reading(none).cloud.empty());
  CHECK(reading(packedFile(variedFile(1, 0), {.chunked = false})).cloud.empty());
  std::uint32_t body = 0;
  std::memcpy(&body, none.data() + 96, sizeof body);
  CHECK(reading(none.substr(0, body)).cloud.empty());
  LasBytes tail = variedFile(6, 500);
  tail.tail = lasLongRecord("late", 9, "behind the table");
  tail.longRecords = 1;
  const StoredCloud stored = reading(packedFile(tail));
  CHECK(stored.cloud.storedAs.baggage->sentence == "1 record of LAS: 'late' 9");
  CHECK(written(stored.cloud).ends_with(tail.tail));
}

TEST_CASE("LAZ chunks of the usual size, on both sides of their end, are unpacked on many threads") {
  for (const std::size_t count : {std::size_t{50'000}, std::size_t{50'001}, std::size_t{220'000}}) {
    CAPTURE(count);
    const LasBytes las = variedFile(count > 200'000 ? 6 : 1, count);
    const PointCloud cloud = reading(packedFile(las)).cloud;
    REQUIRE(cloud.size() == count);
    CHECK(pointsOf(written(cloud)) == las.points);
  }
}

TEST_CASE("a single LAZ chunk of very many points is unpacked in pieces") {
  const std::size_t count = 600'000;  // more than are unpacked at a time
  const LasBytes las = variedFile(0, count);
  CHECK(rowsOf(packedFile(las, {.chunked = false})) == las.points);
}

TEST_CASE("LAZ files of other programs are unpacked as by laz-perf") {
  const std::filesystem::path folder = scannedFiles();
  if (folder.empty()) return;
  struct Truth {
    const char* name;
    std::size_t points;
    std::uint64_t rows;  // checksum of laz-perf 0.0.7's output
  };
  for (const Truth& truth :
       {Truth{"simple.laz", 1065, 0x6e3fea813c9358bfu}, Truth{"plane.laz", 28185, 0x4e995f43a72d7fbau},
        Truth{"ellipsoid.laz", 100'000, 0xed2a0eb6a0fdb610u}, Truth{"autzen_trim.laz", 110'000, 0x7d5e64d0bf3e4836u},
        Truth{"1_4_w_evlr.laz", 1000, 0xf3b0aa6f30a0d3a3u}, Truth{"simple.copc.laz", 1065, 0x9e739c9013d0122du}}) {
    CAPTURE(std::string(truth.name));
    const StoredCloud stored = readCloud(folder / truth.name);
    CHECK(stored.cloud.size() == truth.points);
    const std::string back = written(stored.cloud);
    std::uint16_t rowBytes = 0;
    std::memcpy(&rowBytes, back.data() + 105, sizeof rowBytes);
    CHECK(checksumOf(pointsOf(back).substr(0, truth.points * rowBytes)) == truth.rows);
  }
  CHECK(written(readCloud(folder / "simple.laz").cloud) == bytesOf(folder / "simple.las"));
}

TEST_CASE("a damaged or inconsistent LAZ file is refused with its byte") {
  const LasBytes las = variedFile(3, 3000);
  const std::string good = packedFile(las, {.chunks = {1000, 2000}});
  const std::size_t record = 227, data = record + 54;
  std::uint32_t body = 0;
  std::memcpy(&body, good.data() + 96, sizeof body);
  std::int64_t table = 0;
  std::memcpy(&table, good.data() + body, sizeof table);
  const OneOther with{good};
  const auto byte = [](std::size_t at) { return fmt::format(": byte {}: ", at); };
  refuses("a.las", good, "read");
  with(record + 2, std::uint8_t{'m'}, ": byte 104: the points are packed (LAZ), but the record...");
  with(data, std::uint16_t{3}, byte(data) + "compressor 3 does not apply...");
  with(data, std::uint16_t{0}, byte(data) + "compressor 0 does not apply...");
  with(data + 2, std::uint16_t{1}, byte(data + 2) + "coder 1...");
  with(data + 12, std::uint32_t{0}, byte(data + 12) + "chunks of no points...");
  with(data + 32, std::uint16_t{2}, byte(data + 32) + "points are packed as 2 items...");
  with(data + 34, std::uint16_t{9}, byte(data + 34) + "item 1 is of kind 9...");
  with(data + 36, std::uint16_t{21}, byte(data + 34) + "item 1 is of kind 6 and 21 bytes...");
  with(data + 38, std::uint16_t{1}, byte(data + 34) + "item 1 is of version 1, as programs...");
  with(data + 38, std::uint16_t{3}, byte(data + 34) + "item 1 is of version 3...");
  with(body, std::int64_t{12}, byte(body) + "the table of chunks is at byte 12...");
  with(body, std::int64_t{1} << 60,
       "...the file ends before its table of chunks, which is said to be at byte 1152921504606846976...");
  with(body, std::int64_t{-7}, byte(body) + "the table of chunks is at byte -7...");
  const auto at = static_cast<std::size_t>(table);
  with(at, std::uint32_t{1}, byte(at) + "a table of chunks of version 1...");
  with(at + 4, std::uint32_t{1}, byte(at) + "the table has 1 chunks, and 2000 of 3000 points...");
  with(at + 4, std::uint32_t{0}, byte(at) + "the table has 0 chunks...");
  with(at + 4, std::uint32_t{0xffffffff}, byte(at) + "a table of 4294967295 chunks...");
  with(107, std::uint32_t{3001}, byte(at) + "the table has 2 chunks, and 1 of 3001 points...");
  with(107, std::uint32_t{2999}, byte(at) + "chunk 2 of 2 claims 2000 points...");
  for (const std::size_t end : {std::size_t{body + 4}, body + std::size_t{100}, at, at + 6})
    refuses("a.las", good.substr(0, end), ": byte ...");
  refuses("a.las", good.substr(0, body + 4), "...the file ends before the position of its table...");
  refuses("a.las", good.substr(0, at),
          fmt::format("{}the file ends before its table of chunks, which is said to be at byte {}; it is truncated, or "
                      "its header is wrong",
                      byte(at), at));
}

TEST_CASE("LAZ layers of wrong size or count are refused with their byte") {
  const std::string good = packedFile(variedFile(7, 2000, 2), {.chunks = {800, 1200}});
  std::uint32_t body = 0;
  std::memcpy(&body, good.data() + 96, sizeof body);
  const std::size_t chunk = body + 8, rowBytes = 36 + 2;
  const OneOther with{good};
  refuses("a.las", good, "read");
  with(chunk + rowBytes, std::uint32_t{799}, "...a chunk of 799 points, where the table has 800...");
  with(chunk + rowBytes + 4, std::uint32_t{0xffffff}, "...layer 1 of 12 has 16777215 bytes...");
  with(chunk + rowBytes + 4, std::uint32_t{8}, "...ends inside them, or is damaged...");
}

TEST_CASE("LAZ points with wave packets are read, with the packets if the format stores one stream") {
  constexpr std::size_t kPoints = 300;
  for (const auto& [plain, format] : {std::pair{1u, 4u}, std::pair{3u, 5u}, std::pair{6u, 9u}, std::pair{8u, 10u}}) {
    CAPTURE(format);
    const LasBytes without = variedFile(plain, kPoints);
    LasBytes las{.minor = 4, .format = format, .pointBytes = without.pointBytes + 29};
    las.count = kPoints;
    std::uint64_t offset = 60;
    for (std::size_t i = 0; i < kPoints; ++i) {
      std::string packet(kLazWaveBytes, '\0');
      const auto size = static_cast<std::uint32_t>(88 + i % 3);
      packet[0] = static_cast<char>(i % 5);
      putAt(packet, 1, offset);
      putAt(packet, 9, size);
      putAt(packet, 13, 0.5f * static_cast<float>(i));
      putAt(packet, 17, static_cast<float>(i) / 7);
      las.points += without.points.substr(i * without.pointBytes, without.pointBytes) + packet;
      offset += i % 4 == 0 ? 1'000 : i % 50 == 3 ? std::uint64_t{1} << 40 : i % 9 == 1 ? 0 : size;
    }
    const StoredCloud packed = reading(packedFile(las)), bare = reading(without.text());
    REQUIRE(packed.cloud.size() == kPoints);
    CHECK(packed.cloud.positions == bare.cloud.positions);
    CHECK(packed.cloud.colors == bare.cloud.colors);
    const bool layered = format >= 6;
    CHECK(std::ranges::count(packed.lost, "where the waves of points are, which is not unpacked") == (layered ? 1 : 0));
    if (!layered) CHECK(rowsOf(packedFile(las)) == las.points);
  }
}

TEST_CASE("LAS converted to LAZ and back equals LAS written directly, byte by byte") {
  for (const unsigned format : {0u, 1u, 2u, 3u, 6u, 7u, 8u})
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{3000}}) {
      CAPTURE(format);
      CAPTURE(count);
      LasBytes las = variedFile(format, count, 2);
      las.records = lasRecord("LASF_Projection", 2112, "GEOGCS[...]") + lasRecord("a vendor", 7, std::string(300, 'x'));
      las.recordCount = 2;
      las.padding = "\xdd\xcc";
      las.tail = las.minor == 4 ? lasLongRecord("late", 9, std::string(7000, 'e')) : "bytes of no known record";
      las.longRecords = las.minor == 4 ? 1 : 0;
      const StoredCloud stored = reading(las.text());
      const std::string packed = written(stored.cloud, ".laz");
      CHECK(cloudFormats().toWrite("a.laz").lacks(stored.cloud).empty());
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

TEST_CASE("all points of a COPC octree are read in file order, and the lost octree is reported") {
  const CopcFile file = copcFile();
  const StoredCloud stored = reading(file.text);
  CHECK(stored.cloud.size() == 900);
  CHECK(stored.lost == std::vector<std::string>{"the octree of COPC: 3 nodes on 3 levels"});
  const std::string back = written(stored.cloud);
  CHECK(pointsOf(back).substr(0, file.rows.size()) == file.rows);
  CHECK(back.ends_with("stays"));
  CHECK(back.find("copc") == back.npos);
  CHECK(stored.cloud.storedAs.baggage->sentence == "1 record of LAS: 'late' 3");
  const ScratchFolder folder;
  std::ofstream(folder / "a.copc.laz", std::ios::binary) << file.text;
  CHECK(cloudFormats().toRead(folder / "a.copc.laz").name == "COPC");
  CHECK(contentsOf(folder / "a.copc.laz").elements.at(0).count == 900);
}

TEST_CASE("a COPC hierarchy with cycles or entries outside the file is refused with its byte") {
  const CopcFile good = copcFile();
  const auto with = [&](std::size_t at, const CopcNode& node, const std::string& expected) {
    CopcFile file = good;
    file.put(at, node);
    refuses("a.las", file.text, expected);
  };
  const auto say = [](std::size_t at, const char* what) { return fmt::format(": byte {}: {}...", at, what); };
  const std::size_t root = good.root, page = good.page;
  refuses("a.las", good.text, "read");
  with(page, {{1, 0, 1, 0}, root, 64, -1}, say(page + 16, "the page of the hierarchy at byte"));
  with(page, {{1, 0, 1, 0}, page, 64, -1}, "...is referenced twice...");
  with(root + 32, {{1, 0, 1, 0}, 1u << 30, 64, -1}, say(root + 48, "a page of 64 bytes"));
  with(root + 32, {{1, 0, 1, 0}, page, 33, -1}, say(root + 48, "a page of 33 bytes"));
  with(root + 32, {{1, 0, 1, 0}, page, -32, -1}, say(root + 48, "a page of 0 bytes"));
  with(page, {{1, 2, 1, 0}, 0, 0, 0}, say(page, "a node 1-2-1-0, which is not in an octree"));
  with(page, {{-1, 0, 0, 0}, 0, 0, 0}, say(page, "a node -1-0-0-0"));
  with(page, {{31, 0, 0, 0}, 0, 0, 0}, say(page, "a node 31-0-0-0"));
  with(page, {{1, 0, 1, 0}, root, 10, -2}, say(page + 24, "a node of -2 points"));
  with(page, {{1, 0, 1, 0}, root, 10, 0}, say(page + 24, "a node of 0 points in 10 bytes"));
  with(page, {{1, 0, 1, 0}, 100, 10, 5}, say(page + 16, "a node at byte 100, outside the points"));
  with(page, {{1, 0, 1, 0}, std::uint64_t{1} << 63, 10, 5}, "...outside the points...");
  with(page, {{0, 0, 0, 0}, 0, 0, 0}, "...the node 0-0-0-0 is a duplicate...");
  with(page, {{1, 0, 1, 0}, 0, 0, 0}, say(good.info + 40, "the nodes of the hierarchy have 800"));
  std::uint64_t first = 0;
  std::memcpy(&first, good.text.data() + root + 16, sizeof first);
  with(page, {{1, 0, 1, 0}, first + 5, 200, 100}, "...overlap...");
  CopcFile far = good;
  putAt(far.text, far.info + 40, std::uint64_t{1} << 50);
  refuses("a.las", far.text, say(far.info + 40, "a page of 64 bytes of the hierarchy"));
}

}  // namespace palpate::test::laz_format_test
