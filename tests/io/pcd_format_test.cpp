// PCD in its three encodings: meaning of the fields, errors with line or byte, and lossless conversion.
#include "engine/io/known_formats.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <limits>

#include "engine/io/lzf.hpp"
#include "engine/io/saving.hpp"
#include "tests/io/file_cases.hpp"

namespace palpate::test::pcd_format_test {
namespace {

using Color = std::array<std::uint8_t, 4>;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

StoredCloud reading(const std::string& text) { return readingFile("a.pcd", text); }

PointCloud again(const PointCloud& cloud, bool ascii) {
  const ScratchFolder folder;
  writeCloud(folder / "b.pcd", cloud, {.ascii = ascii});
  CHECK(contentsOf(folder / "b.pcd").elements.at(0).count == cloud.size());
  return readCloud(folder / "b.pcd").cloud;
}

std::string header(const std::string& fields, const std::string& sizes, const std::string& types, std::size_t points,
                   const std::string& data) {
  const std::string count = std::to_string(points);
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " +
         types + "\nWIDTH " + count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA " + data + "\n";
}

template <class... Values>
std::string bytesOf(Values... values) {
  std::string out;
  const auto add = [&](auto value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); };
  (add(values), ...);
  return out;
}

/// Stored in literal runs, without compression.
std::string stored(const std::string& bytes) {
  std::string out;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const std::string piece = bytes.substr(at, 32);
    out += static_cast<char>(piece.size() - 1);
    out += piece;
  }
  return bytesOf(static_cast<std::uint32_t>(out.size()), static_cast<std::uint32_t>(bytes.size())) + out;
}

std::string unpacked(const std::string& in, std::size_t bytes) {
  std::string out(bytes, '?');
  const auto bad = unpackLzf(std::as_bytes(std::span(in)), std::as_writable_bytes(std::span(out)));
  return bad ? "bad at " + std::to_string(*bad) : out;
}

}  // namespace

TEST_CASE("PCD text fields become positions, normals, colours and named attributes") {
  const float packed = std::bit_cast<float>(std::uint32_t{0x00ff8001});
  const StoredCloud read = reading(
      header("x y z normal_x normal_y normal_z rgb curvature", "4 4 4 4 4 4 4 4", "F F F F F F F F", 2, "ascii") +
      fmt::format("1 2 3 0 0 1 {} 0.5\n\n4 5 6.5 1 0 0 1e-45 0.25\n", packed));
  REQUIRE(read.cloud.size() == 2);
  CHECK(read.lost.empty());
  CHECK(read.cloud.fileCoordinates(1) == DVec3(4, 5, 6.5));
  CHECK(read.cloud.normals.at(1) == Vec3(1, 0, 0));
  CHECK(read.cloud.colors.at(0) == Color{255, 128, 1, 255});
  CHECK(read.cloud.colors.at(1) == Color{0, 0, 1, 255});  // a denormal number
  REQUIRE(read.cloud.extra.size() == 1);
  CHECK(read.cloud.extra[0].name == "curvature");
}

TEST_CASE("binary PCD points are read in any type, with padding and several numbers per field") {
  const std::string head =
      "VERSION .7\nFIELDS x y z _ rgba hist ring t\nSIZE 8 8 8 1 4 4 2 8\nTYPE F F F U U F U U\n"
      "COUNT 1 1 1 4 1 2 1 1\nWIDTH 1\nHEIGHT 2\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS 2\nDATA ";
  const auto row = [](double x, std::uint32_t color) {
    return std::array{bytesOf(x),
                      bytesOf(5200000.001),
                      bytesOf(-1.0),
                      bytesOf(std::uint32_t{9}),
                      bytesOf(color),
                      bytesOf(0.5f, 1.5f),
                      bytesOf(std::uint16_t{7}),
                      bytesOf(std::uint64_t{1} << 40)};
  };
  const auto first = row(4500000.001, 0x80ff0102), second = row(4500000.002, 0x00000000);
  std::string rows, columns;
  for (const auto* one : {&first, &second})
    for (const std::string& part : *one) rows += part;
  for (std::size_t k = 0; k < first.size(); ++k) columns += first[k] + second[k];
  for (const std::string& text : {head + "binary\n" + rows, head + "binary_compressed\n" + stored(columns)}) {
    const StoredCloud read = reading(text);
    REQUIRE(read.cloud.size() == 2);
    CHECK(read.cloud.fileCoordinates(0) == DVec3(4500000.001, 5200000.001, -1));
    CHECK(read.cloud.fileCoordinates(1).x == 4500000.002);
    CHECK(read.cloud.colors.at(0) == Color{255, 1, 2, 128});
    CHECK(read.cloud.storedAs.alpha);
    REQUIRE(read.cloud.extra.size() == 4);
    CHECK(read.cloud.extra[1].name == "hist_1");
    CHECK(loadScalar<float>(read.cloud.extra[1].data.data() + 4) == 1.5f);
    CHECK(loadScalar<std::uint16_t>(read.cloud.extra[2].data.data()) == 7);
    CHECK(loadScalar<std::uint64_t>(read.cloud.extra[3].data.data()) == std::uint64_t{1} << 40);
    CHECK(read.lost == std::vector<std::string>{"the grid of 1 x 2"});
    for (const bool ascii : {false, true}) {
      const PointCloud back = again(read.cloud, ascii);
      CHECK(back.fileCoordinates(0) == read.cloud.fileCoordinates(0));
      CHECK(back.colors == read.cloud.colors);
      CHECK(back.storedAs.comments == std::vector<std::string>{"comment viewpoint: 1 2 3 1 0 0 0"});
      for (std::size_t k = 0; k < 4; ++k) CHECK(back.extra.at(k).data == read.cloud.extra[k].data);
    }
  }
}

TEST_CASE("compressed PCD copies earlier bytes, also overlapping its own output") {
  using namespace std::string_literals;
  CHECK(unpacked("\2abc", 3) == "abc");
  CHECK(unpacked("\0a\x20\0"s, 4) == "aaaa");              // a copy of three bytes, from one byte back
  CHECK(unpacked("\1ab\xe0\2\1", 13) == "ababababababa");  // nine bytes from two bytes back, and the two literals
  CHECK(unpacked("\0a\x20\1"s, 4) == "bad at 2");          // from before the beginning
  CHECK(unpacked("\5ab", 6) == "bad at 0");
  CHECK(unpacked("\2abc", 2) == "bad at 0");
  CHECK(unpacked("\2abc", 4) == "bad at 4");
  CHECK(unpacked("\xe0", 4) == "bad at 0");
}

TEST_CASE("PCD points without a finite position are left out and counted") {
  const std::string head = header("x y z normal_x normal_y normal_z", "4 4 4 4 4 4", "F F F F F F", 3, "binary");
  const std::string good = bytesOf(1.f, 2.f, 3.f, 0.f, 1.f, 0.f), none = bytesOf(kNaN, kNaN, kNaN, kNaN, kNaN, kNaN);
  const StoredCloud read = reading(head + good + none + good);
  CHECK(read.cloud.size() == 2);
  CHECK(read.lost == std::vector<std::string>{"1 point without a finite position below 1e30"});
  for (const float half : {kNaN, HUGE_VALF})
    CHECK(reading(head + good + none + bytesOf(1.f, half, 3.f, 0.f, 1.f, 0.f)).cloud.size() == 1);
  std::string many = header("x y z normal_x normal_y normal_z", "4 4 4 4 4 4", "F F F F F F", 20, "binary");
  for (int k = 0; k < 19; ++k) many += good;
  many += bytesOf(9.f, 2.f, 3.f, kNaN, kNaN, kNaN);  // gets the normal of its neighbour
  CHECK(reading(many).cloud.normals.at(19) == Vec3(0, 1, 0));
}

TEST_CASE("a cloud of any number of points is read back from PCD unchanged") {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{4096}, std::size_t{65'537}}) {
    CAPTURE(count);
    PointCloud cloud;
    for (std::size_t i = 0; i < count; ++i) {
      cloud.positions.emplace_back(0.1f * static_cast<float>(i), 1 / 3.0f, -2);
      cloud.normals.emplace_back(0, 0, i % 2 == 0 ? 1 : -1);
      cloud.colors.push_back({static_cast<std::uint8_t>(i), 2, 3, 255});
    }
    if (count > 0) cloud.extra.push_back({"ring", ScalarType::i16, std::vector<std::byte>(2 * count, std::byte{3})});
    markAsOurs(cloud);
    for (const bool ascii : {false, true}) {
      const PointCloud back = again(cloud, ascii);
      CHECK(back.positions == cloud.positions);
      CHECK(back.normals == cloud.normals);
      CHECK(back.colors == cloud.colors);
      CHECK(isOurs(back.storedAs.comments));
      if (count > 0) CHECK(back.extra.at(0).data == cloud.extra[0].data);
    }
  }
}

TEST_CASE("a damaged or inconsistent PCD file is refused with its line or byte") {
  const std::string ascii = header("x y z", "4 4 4", "F F F", 2, "ascii");
  refuses("a.pcd", "plywood\n", ": is not a PCD file");
  refuses("a.pcd", "", ": is empty; it contains no points");
  refuses("a.pcd", ascii + "1 2 3\n", ":12: the file ends after 1 of 2 points");
  refuses("a.pcd", ascii + "1 2 3\n4 5 6\n7 8 9\n", ":13: more than the 2 points of the header");
  refuses("a.pcd", ascii + "1 2 3\n4 5\n", ":12: found '' for 'z', expected a number");
  refuses("a.pcd", ascii + "1 2 3\n4 5",
          ":12: found '' for 'z', expected a number; the file ends in this line, it may be truncated");
  refuses("a.pcd", ascii + "1 2 3\n4 5 6 7\n", ":12: a point of more numbers than the header has fields");
  refuses("a.pcd", ascii + "1 2 3\n4 five 6\n", ":12: ...");
  refuses("a.pcd", header("x y", "4 4", "F F", 1, "ascii"), "...no scalar property 'z'...");
  refuses("a.pcd", header("x y z x", "4 4 4 4", "F F F F", 1, "ascii"), ":3: a second field 'x'");
  refuses("a.pcd", header("x y z", "4 4 3", "F F F", 1, "ascii"), ":10: field 'z' has numbers F of 3 bytes");
  refuses("a.pcd", header("x y z", "4 4", "F F F", 1, "ascii"), ":4: SIZE has 2 entries for 3 fields");
  refuses("a.pcd", header("x y z", "4 4 4", "F F Q", 1, "ascii"), ":5: type 'Q'; expected I, U or F");
  refuses("a.pcd", header("x y z", "4 4 4", "F F F", 1, "zip"), ":10: expected 'ascii', 'binary'...");
  refuses("a.pcd", "VERSION 0.7\nFIELDS x y z\nWIDTH 3\nHEIGHT 2\nPOINTS 5\nDATA ascii\n",
          ":6: 5 points in a grid of 3 x 2");
  const std::string binary = header("x y z", "4 4 4", "F F F", 2, "binary");
  refuses("a.pcd", binary + bytesOf(1.f, 2.f, 3.f),
          fmt::format(": byte {}: the file ends after 1 of 2 points; it is truncated, or its header is wrong",
                      binary.size() + 12));
  const std::string lying = header("x y z", "4 4 4", "F F F", 1000000000000, "binary");
  refuses("a.pcd", lying + bytesOf(1.f), "...ends after 0 of 1000000000000 points...");
  const std::string packed = header("x y z", "4 4 4", "F F F", 2, "binary_compressed");
  const std::string body = stored(std::string(24, '\0'));
  refuses("a.pcd", packed + body, "read");
  refuses("a.pcd", packed + body.substr(0, 5), "...ends before its compressed points...");
  refuses("a.pcd", packed + body.substr(0, 20), "...ends inside its 25 compressed bytes...");
  refuses("a.pcd", packed + stored(std::string(36, '\0')), "...36 bytes of points, where 2 of 12...");
  const std::string huge = header("x y z", "4 4 4", "F F F", 300000000, "binary_compressed");
  refuses("a.pcd", huge + bytesOf(std::uint32_t{3}, std::uint32_t{3600000000}) + "abc", "...cannot become...");
}

TEST_CASE("properties that PCD cannot hold are listed") {
  StoredCloud some{.cloud = reading(header("x y z", "4 4 4", "F F F", 1, "ascii") + "1 2 3\n").cloud,
                   .triangles = {{0, 0, 0}},
                   .lost = {}};
  some.cloud.colors = {{1, 2, 3, 255}};
  some.cloud.extra.push_back({"rgb", ScalarType::f32, std::vector<std::byte>(4)});
  CHECK(lostOnTheWay(some, pcdFormat()) ==
        std::vector<std::string>{"1 triangle", "the field 'rgb', because another one is written under its name"});
  CHECK(again(some.cloud, false).colors == some.cloud.colors);
}

}  // namespace palpate::test::pcd_format_test
