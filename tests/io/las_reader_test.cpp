// The unit of length of a LAS file, from its coordinate system, and what becomes of it. LAS and LAZ are read by many
// threads: the result does not depend on their number, nor on which two LAZ chunks a thread unpacks together.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "engine/cloud/length_unit.hpp"
#include "engine/io/known_formats.hpp"
#include "tests/io/las_points.hpp"
#include "tests/io/laz_bytes.hpp"
#include "tests/near.hpp"

namespace palpate::test::las_reader_test {

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

StoredCloud readBy(const std::filesystem::path& file, unsigned threads) {
  return readCloud(file, nullptr, {.threads = threads});
}

template <class Array>
bool sameBytes(const Array& a, const Array& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
}

/// Name of the part that differs; empty if none does.
std::string difference(const StoredCloud& a, const StoredCloud& b) {
  const PointCloud &p = a.cloud, &q = b.cloud;
  if (p.origin != q.origin) return "origin";
  if (!sameBytes(p.positions, q.positions)) return "positions";
  if (!sameBytes(p.exactPositions, q.exactPositions)) return "exact positions";
  if (!sameBytes(p.normals, q.normals)) return "normals";
  if (!sameBytes(p.colors, q.colors)) return "colours";
  if (a.lost != b.lost) return "what is lost";
  if (namesOf(p) != namesOf(q)) return "names";
  for (std::size_t k = 0; k < p.extra.size(); ++k)
    if (p.extra[k].type != q.extra[k].type || !sameBytes(p.extra[k].data, q.extra[k].data)) return p.extra[k].name;
  return "";
}

/// A file of positions and normals, as extra bytes.
LasBytes withNormals(const std::vector<std::array<float, 3>>& normals) {
  std::string descriptors;
  for (const std::string_view name : kLasNormals) descriptors += lasDescriptor(std::string(name), 9);
  LasBytes las{.minor = 4, .format = 0, .pointBytes = 32, .records = lasRecord("LASF_Spec", 4, descriptors)};
  las.recordCount = 1;
  las.count = normals.size();
  for (std::size_t i = 0; i < normals.size(); ++i) {
    std::string row(32, '\0');
    for (std::size_t k = 0; k < 3; ++k) putAt(row, 4 * k, static_cast<std::int32_t>(i * (k + 1) % 1000));
    for (std::size_t k = 0; k < 3; ++k) putAt(row, 20 + 4 * k, normals[i][k]);
    las.points += row;
  }
  return las;
}

PointCloud readText(const std::string& text, unsigned threads) {
  const ScratchFolder folder;
  std::ofstream(folder / "a.las", std::ios::binary) << text;
  return readBy(folder / "a.las", threads).cloud;
}

std::string rowsBy(const std::string& text, unsigned threads) {
  return pointsOf(written(reading(text, threads).cloud));
}

/// Offsets of the chunks of a packed file, and the end of the last one.
std::vector<std::size_t> chunkPlaces(const LasBytes& las, const std::vector<std::size_t>& chunks,
                                     const std::string& packed) {
  std::uint32_t body = 0;
  std::memcpy(&body, packed.data() + 96, sizeof body);
  std::vector<std::size_t> places{body + std::size_t{8}};
  std::size_t done = 0;
  for (const std::size_t points : chunks) {
    const auto rows = std::as_bytes(std::span(las.points)).subspan(done * las.pointBytes, points * las.pointBytes);
    places.push_back(places.back() + encodeLazChunk(lazLayoutFor(las.format, las.pointBytes), rows).size());
    done += points;
  }
  return places;
}

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

TEST_CASE("any number of threads reads the same LAS points, on both sides of every block boundary") {
  const ScratchFolder folder;
  // The first block has 65,536 rows, the next twice as many; threads take 4096 rows, and scan 512 at a time.
  for (const unsigned format : {0u, 3u, 7u})
    for (const std::size_t count : {0, 1, 3, 511, 512, 513, 4097, 65'535, 65'536, 65'537, 196'609}) {
      if (count > 4097 && format != 3) continue;
      CAPTURE(format);
      CAPTURE(count);
      const LasBytes las = variedFile(format, count, 2);
      const std::filesystem::path file = folder / "a.las";
      std::ofstream(file, std::ios::binary) << las.text();
      const StoredCloud one = readBy(file, 1);
      REQUIRE(one.cloud.size() == count);
      CHECK(pointsOf(written(one.cloud)) == las.points);
      for (const unsigned threads : {2u, 3u, 16u}) CHECK(difference(readBy(file, threads), one) == "");
    }
}

TEST_CASE("any number of threads unpacks the same LAZ points, in chunks of any length") {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / "a.laz";
  for (const unsigned format : {1u, 3u, 7u})
    for (const std::vector<std::size_t>& chunks :
         {std::vector<std::size_t>{}, {1}, {1, 1, 1}, {511, 512, 513}, {1023, 1024, 1025, 1}, {5000, 1, 20'000}}) {
      CAPTURE(format);
      CAPTURE(chunks.size());
      std::size_t count = 0;
      for (const std::size_t points : chunks) count += points;
      const LasBytes las = variedFile(format, count, 3);
      std::ofstream(file, std::ios::binary) << packedFile(las, {.chunks = chunks});
      const StoredCloud one = readBy(file, 1);
      REQUIRE(one.cloud.size() == count);
      if (count > 0) CHECK(pointsOf(written(one.cloud)) == las.points);
      for (const unsigned threads : {2u, 3u, 16u}) CHECK(difference(readBy(file, threads), one) == "");
    }
}

TEST_CASE("a LAS attribute that is zero except at one point is kept, and one that is zero everywhere is left out") {
  for (const std::size_t at : {std::size_t{0}, std::size_t{70'000}, std::size_t{199'999}}) {
    CAPTURE(at);
    LasBytes las{.format = 1, .pointBytes = 28};
    las.count = 200'000;
    las.points.assign(las.count * 28, '\0');
    putAt(las.points, at * 28 + 12, std::uint16_t{77});  // intensity
    putAt(las.points, at * 28 + 20, -0.0);               // negative zero: equal to zero, but with one bit set
    for (const unsigned threads : {1u, 3u, 16u}) {
      CAPTURE(threads);
      const PointCloud cloud = readText(las.text(), threads);
      CHECK(namesOf(cloud) == std::vector<std::string>{"intensity", "gps_time"});
      CHECK(valueOf(cloud, "intensity", at) == 77);
      CHECK(std::signbit(valueOf(cloud, "gps_time", at)));
      std::size_t others = 0;
      for (const Attribute& attribute : cloud.extra) {
        const std::size_t each = sizeOf(attribute.type);
        for (std::size_t k = 0; k < attribute.data.size(); ++k)
          others += k / each != at && attribute.data[k] != std::byte{0};
      }
      CHECK(others == 0);
    }
  }
}

TEST_CASE("LAS normals are normalized, missing ones are filled, and non-finite ones stay attributes") {
  std::vector<std::array<float, 3>> normals(5000, {0, 0, 1});
  normals[10] = {0, 3, 4};
  normals[4999] = {1 + 1e-6f, 0, 0};  // within the tolerance of unit length
  for (const unsigned threads : {1u, 2u, 16u}) {
    CAPTURE(threads);
    PointCloud cloud = readText(withNormals(normals).text(), threads);
    CHECK(cloud.extra.empty());
    REQUIRE(cloud.normals.size() == normals.size());
    CHECK(cloud.normals[10] == Vec3(0, 0.6f, 0.8f));
    CHECK(cloud.normals[4999] == Vec3(1 + 1e-6f, 0, 0));
    CHECK(cloud.normals[9] == Vec3(0, 0, 1));

    std::vector<std::array<float, 3>> some = normals;
    some[600] = {0, 0, 0};
    cloud = readText(withNormals(some).text(), threads);
    REQUIRE(cloud.hasNormals());
    CHECK(glm::length(cloud.normals[600]) == near(1, 1e-6));
    CHECK(cloud.normals[599] == Vec3(0, 0, 1));

    some[4998] = {std::numeric_limits<float>::infinity(), 0, 0};
    cloud = readText(withNormals(some).text(), threads);
    CHECK(!cloud.hasNormals());
    CHECK(namesOf(cloud) == std::vector<std::string>(kLasNormals.begin(), kLasNormals.end()));
    CHECK(valueOf(cloud, "NormalY", 10) == 3);
    CHECK(valueOf(cloud, "NormalX", 4998) == std::numeric_limits<double>::infinity());
    CHECK(pointsOf(written(cloud)) == withNormals(some).points);
  }
}

TEST_CASE("two LAZ chunks unpacked together are exact, even if one is much longer") {
  const std::vector<std::size_t> chunks = {1, 1, 3000, 1, 2, 2049, 1024, 1025, 700, 9, 2500, 2499, 5};
  for (const unsigned format : {0u, 1u, 2u, 3u, 6u, 8u})
    for (const unsigned more : {0u, 12u}) {
      std::size_t count = 0;
      for (const std::size_t points : chunks) count += points;
      const LasBytes las = variedFile(format, count, more);
      const std::string packed = packedFile(las, {.chunks = chunks});
      for (const unsigned threads : {1u, 2u, 16u}) {  // 16: each chunk alone
        CAPTURE(format);
        CAPTURE(more);
        CAPTURE(threads);
        CHECK(rowsBy(packed, threads) == las.points);
      }
    }
}

TEST_CASE("a damaged LAZ chunk of two unpacked together is reported, and the first of two damaged ones") {
  const std::vector<std::size_t> chunks = {4000, 3000, 2000, 2500, 1500};
  for (const unsigned format : {3u, 7u}) {
    const LasBytes las = variedFile(format, 13'000, 2);
    const std::string good = packedFile(las, {.chunks = chunks});
    const std::vector<std::size_t> places = chunkPlaces(las, chunks, good);
    refuses("a.las", good, "read", {.threads = 1});
    // Bytes of 0xff up to a chunk's end: sooner or later they decode to something impossible, or are too few.
    const auto refused = [&](std::initializer_list<std::array<std::size_t, 2>> damaged) {
      std::string text = good;
      for (const auto [k, hundredths] : damaged) {
        const std::size_t from = (places[k + 1] - places[k]) * hundredths / 100;
        std::fill(text.begin() + static_cast<std::ptrdiff_t>(places[k] + from),
                  text.begin() + static_cast<std::ptrdiff_t>(places[k + 1]), '\xff');
      }
      return refusalOf("a.las", text, {.threads = 1});
    };
    const auto sentence = [&](std::size_t k) {
      return fmt::format(": byte {}: the chunk of {} points that begins at byte {} ends inside them, or is damaged",
                         places[k + 1], chunks[k], places[k]);
    };
    const std::size_t early = 5, late = 80;  // far more than a thousand rows lie between them
    for (std::size_t k = 0; k < chunks.size(); ++k) {
      CAPTURE(format);
      CAPTURE(k);
      CHECK(refused({{k, early}}) == sentence(k));
    }
    CHECK(refused({{0, late}, {1, early}}) == sentence(0));
    CHECK(refused({{2, late}, {3, early}}) == sentence(2));
    CHECK(refused({{1, late}, {2, early}}) == sentence(1));
  }
}

TEST_CASE("the unchecked range decoder decodes what the checked one does while enough bytes remain") {
  constexpr int kCount = 20'000;
  RangeEncoder encoder;
  SymbolModel symbols(256);
  BitModel bit;
  Dice dice(3);
  std::vector<std::uint32_t> values;
  for (int i = 0; i < kCount; ++i) values.push_back(dice.oneIn(3) ? dice.below(0xffffffffu) : dice.below(20));
  for (const std::uint32_t value : values) {
    encoder.symbol(symbols, value % 256);
    encoder.bit(bit, value % 5 == 0);
    encoder.bits(1 + value % 32, value >> (31 - value % 32));
  }
  const std::vector<std::byte> stream = encoder.finish();
  RangeDecoder careful(stream);
  SymbolModel model(256);
  BitModel other;
  bool same = true;
  int quick = 0;
  for (const std::uint32_t value : values) {
    const auto decode = [&](auto& decoder) {
      same = same && decoder.symbol(model) == value % 256 && decoder.bit(other) == (value % 5 == 0) &&
             decoder.bits(1 + value % 32) == value >> (31 - value % 32);
    };
    RangeDecoderOf<false> told(careful);
    if (told.left() >= 4 * RangeDecoderOf<false>::kMaxBytes) {
      decode(told);
      careful = RangeDecoder(told);
      ++quick;
    } else {
      decode(careful);
    }
  }
  CHECK(same);
  CHECK(quick > kCount - 100);
  CHECK(careful.left() == 0);
  CHECK(!careful.isWrong());
}

}  // namespace palpate::test::las_reader_test
