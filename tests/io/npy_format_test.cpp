// Arrays of NumPy, alone and in archives: meaning of their columns, and errors with their byte.
#include "engine/io/known_formats.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "engine/io/zip_archive.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/io/npy_bytes.hpp"

namespace palpate::test::npy_format_test {

using namespace npy;

namespace {

using Color = std::array<std::uint8_t, 4>;

StoredCloud reading(const std::string& text, const char* name = "a.npy") { return readingFile(name, text); }

}  // namespace

TEST_CASE("NPY rows of three, four and six numbers are positions, with an intensity, normals or colours") {
  for (const bool reversed : {false, true}) {
    const std::string order = reversed ? ">" : "<";
    const PointCloud places =
        reading(array("'" + order + "f4'", "(2, 3)", bytes({1.f, 2.f, 3.f, 4.f, 5.f, 6.5f}, reversed))).cloud;
    REQUIRE(places.size() == 2);
    CHECK(places.fileCoordinates(1) == DVec3(4, 5, 6.5));
    CHECK(places.storedAs.position == ScalarType::f32);
    const PointCloud far =
        reading(array("'" + order + "f8'", "(1, 3)", bytes({4500000.001, 5200000.002, 0.003}, reversed), false, 2))
            .cloud;
    CHECK(far.fileCoordinates(0) == DVec3(4500000.001, 5200000.002, 0.003));
    const PointCloud whole =
        reading(array("'" + order + "i8'", "(1, 3)", bytes<std::int64_t>({-7, 1ll << 40, 3}, reversed))).cloud;
    CHECK(whole.fileCoordinates(0) == DVec3(-7, std::ldexp(1.0, 40), 3));
  }
  const PointCloud turned = reading(array("'<f8'", "(2, 3)", bytes({1., 4., 2., 5., 3., 6.}), true)).cloud;
  CHECK(turned.fileCoordinates(0) == DVec3(1, 2, 3));
  CHECK(turned.fileCoordinates(1) == DVec3(4, 5, 6));
  CHECK(reading(array("'<f4'", "(2, 2, 3)", bytes({1.f, 2.f, 3.f, 4.f, 5.f, 6.f, 7.f, 8.f, 9.f, 10.f, 11.f, 12.f})))
            .cloud.size() == 4);
  const PointCloud lit = reading(array("'<f4'", "(1, 4)", bytes({1.f, 2.f, 3.f, 0.25f}))).cloud;
  REQUIRE(lit.extra.size() == 1);
  CHECK(lit.extra[0].name == "intensity");

  const auto six = [](std::initializer_list<float> values) {
    return reading(array("'<f4'", "(2, 6)", bytes(values))).cloud;
  };
  const PointCloud facing = six({1, 2, 3, 0, 0, 1, 4, 5, 6, 0, 1, 0});
  REQUIRE(facing.hasNormals());
  CHECK(facing.normals[1] == Vec3(0, 1, 0));
  CHECK(six({1, 2, 3, 0, 0, 0, 4, 5, 6, 255, 7, 128}).colors.at(1) == Color{255, 7, 128, 255});
  CHECK(six({1, 2, 3, 0, 0, 0, 4, 5, 6, 1, 1, 0.5f}).colors.at(1) == Color{255, 255, 128, 255});
  refuses("a.npy", array("'<f4'", "(1, 6)", bytes({1.f, 2.f, 3.f, 300.f, 0.f, 0.f})), "...have no names...");
}

TEST_CASE("a structured NPY array gives attributes with the names of its fields") {
  const std::string type =
      "[('xyz', '<f8', (3,)), ('', '|V2'), ('normal', '>f4', (3,)), ('red', '|u1'), ('green', '|u1'), "
      "('blue', '|u1'), ('time', '<u8'), ('ok', '|b1'), ('grid', '<i2', (1, 2))]";
  const std::string row = bytes({1., 2., 3.}) + "__" + bytes({0.f, 1.f, 0.f}, true) + "\xff\x07\x80" +
                          bytes<std::uint64_t>({77}) + "\1" + bytes<std::int16_t>({-5, 6});
  const StoredCloud read = reading(array(type, "(2,)", row + row, false, 3));
  REQUIRE(read.cloud.size() == 2);
  CHECK(read.cloud.fileCoordinates(1) == DVec3(1, 2, 3));
  CHECK(read.cloud.normals.at(1) == Vec3(0, 1, 0));
  CHECK(read.cloud.colors.at(1) == Color{255, 7, 128, 255});
  REQUIRE(read.cloud.extra.size() == 4);
  CHECK(read.cloud.extra[0].name == "time");
  CHECK(loadScalar<std::uint64_t>(read.cloud.extra[0].data.data() + 8) == 77);
  CHECK(read.cloud.extra[1].name == "ok");
  CHECK(read.cloud.extra[3].name == "grid_1");
  CHECK(loadScalar<std::int16_t>(read.cloud.extra[2].data.data() + 2) == -5);
  CHECK(read.lost.empty());
  // Floating-point colours, of which only one exceeds 1.
  const std::string real =
      "[('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('red', '<f4'), ('green', '<f4'), ('blue', '<f4')]";
  CHECK(reading(array(real, "(1,)", bytes({1.f, 2.f, 3.f, 0.f, 1.f, 9.f}))).cloud.colors.at(0) == Color{0, 1, 9, 255});
}

TEST_CASE("NPY numbers of any size are read in either byte order") {
  for (const bool big : {false, true}) {
    CAPTURE(big);
    std::string type =
        "[('x', '<f4'), ('y', '>f8'), ('z', '<f4'), ('i2', '<i2'), ('u2', '<u2'), ('i4', '<i4'), ('u8', "
        "'<u8')]";
    if (big) std::ranges::replace(type, '<', '>');
    const std::string row = bytes({1.f}, big) + bytes({2.}, true) + bytes({3.f}, big) + bytes<std::int16_t>({-2}, big) +
                            bytes<std::uint16_t>({258}, big) + bytes<std::int32_t>({-3}, big) +
                            bytes<std::uint64_t>({4}, big);
    const PointCloud cloud = reading(array(type, "(1,)", row)).cloud;
    REQUIRE(cloud.size() == 1);
    CHECK(cloud.fileCoordinates(0) == DVec3(1, 2, 3));
    REQUIRE(cloud.extra.size() == 4);
    CHECK(loadScalar<std::int16_t>(cloud.extra[0].data.data()) == -2);
    CHECK(loadScalar<std::uint16_t>(cloud.extra[1].data.data()) == 258);
    CHECK(loadScalar<std::int32_t>(cloud.extra[2].data.data()) == -3);
    CHECK(loadScalar<std::uint64_t>(cloud.extra[3].data.data()) == 4);
  }
}

TEST_CASE("NPZ arrays with one row per point become attributes of the points") {
  const std::string points = array("'<f4'", "(2, 3)", bytes({1.f, 2.f, 3.f, 4.f, 5.f, 6.f}));
  const std::string colors = array("'|u1'", "(2, 3)", std::string("\x01\x02\x03\x04\x05\x06"));
  const std::string ring = array("'<u2'", "(2,)", bytes<std::uint16_t>({8, 9})),
                    pose = array("'<f8'", "(1,)", bytes({1.}));
  for (const bool wide : {false, true}) {
    const StoredCloud read = reading(zip({{"colors.npy", colors, {}},
                                          {"ring.npy", ring, plainBlock(ring)},
                                          {"points.npy", points, {}},
                                          {"pose.npy", pose, {}},
                                          {"notes.txt", "hello", {}}},
                                         wide),
                                     "a.npz");
    REQUIRE(read.cloud.size() == 2);
    CHECK(read.cloud.fileCoordinates(1) == DVec3(4, 5, 6));
    CHECK(read.cloud.colors.at(1) == Color{4, 5, 6, 255});
    REQUIRE(read.cloud.extra.size() == 1);
    CHECK(loadScalar<std::uint16_t>(read.cloud.extra[0].data.data() + 2) == 9);
    CHECK(read.lost == std::vector<std::string>{"the member 'notes.txt'", "the array 'pose' of shape (1)"});
  }
  // Packed with fixed codes: 'a' ten times is two literals, and a copy of eight from one byte before.
  const std::string packed("\x4b\x4c\x84\x01\x00", 5);
  const std::string file = zip({{"a", "aaaaaaaaaa", packed}});
  const auto members = zipMembers("a.npz", std::as_bytes(std::span(file)));
  REQUIRE(members.size() == 1);
  const auto text = unpackZip("a.npz", std::as_bytes(std::span(file)), members[0]);
  CHECK(std::string(reinterpret_cast<const char*>(text.data()), text.size()) == "aaaaaaaaaa");
}

TEST_CASE("a cloud of any number of points is read back from NPY unchanged") {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{4097}, std::size_t{65'537}}) {
    CAPTURE(count);
    PointCloud cloud;
    for (std::size_t i = 0; i < count; ++i) {
      cloud.positions.emplace_back(0.1f * static_cast<float>(i), 1 / 3.0f, -2);
      cloud.normals.emplace_back(0, 0, i % 2 == 0 ? 1 : -1);
      cloud.colors.push_back({static_cast<std::uint8_t>(i), 2, 3, static_cast<std::uint8_t>(i)});
    }
    cloud.storedAs.alpha = true;
    if (count > 0) cloud.extra.push_back({"ring's", ScalarType::i16, std::vector<std::byte>(2 * count, std::byte{3})});
    const ScratchFolder folder;
    writeCloud(folder / "b.npy", cloud);
    std::ifstream file(folder / "b.npy", std::ios::binary);
    std::string head(128, '\0');
    file.read(head.data(), 128);
    CHECK((10 + static_cast<std::uint8_t>(head[8]) + 256 * static_cast<std::uint8_t>(head[9])) % 64 == 0);
    const PointCloud back = readCloud(folder / "b.npy").cloud;
    CHECK(back.positions == cloud.positions);
    CHECK(back.normals == cloud.normals);
    CHECK(back.colors == cloud.colors);
    if (count == 0) continue;
    CHECK(back.extra.at(0).name == "ring_s");
    CHECK(back.extra.at(0).data == cloud.extra[0].data);
  }
  StoredCloud some{.cloud = {}, .triangles = {{0, 0, 0}}, .lost = {}};
  some.cloud.storedAs.comments = {"comment hello"};
  some.cloud.extra.push_back({"it's", ScalarType::u8, {}});
  CHECK(lostOnTheWay(some, npyFormat()) ==
        std::vector<std::string>{"1 triangle", "comments", "the quotes in the name it's"});
}

TEST_CASE("a damaged or inconsistent NPY array is refused with its byte") {
  const std::string data = bytes({1.f, 2.f, 3.f});
  refuses("a.npy", "hello", ": byte 0: not an array of NumPy: it does not begin as one");
  refuses("a.npy", std::string("\x93NUMPY\x01\x00", 8), ": byte 8: ends inside the array's description");
  refuses("a.npy", array("'<f4'", "(1, 3)", data, false, 4), ": byte 6: version 4...");
  refuses("a.npy", array("'<f4'", "(2, 3)", data), "...the file ends after 1 of 2 rows of an array of shape (2, 3)...");
  refuses("a.npy", array("'<f4'", "(1000000000000000000, 3)", data), "...too many numbers...");
  refuses("a.npy", array("'<f4'", "(1000000000000, 3)", data), "...ends after 1 of 1000000000000 rows...");
  refuses("a.npy", array("'<f2'", "(2, 3)", data), "...the type '<f2', which is not read...");
  refuses("a.npy", array("'|O'", "(2, 3)", data), "...the type '|O', which is not read...");
  refuses("a.npy", array("'<c8'", "(2, 3)", data), "...the type '<c8', which is not read...");
  refuses("a.npy", array("'<f4'", "(1, 3", data), "...the array's description has...");
  refuses("a.npy", array("'<f4'", "(1, -3)", data), "...which is not a value...");
  refuses("a.npy", array("'<f4'", "(3,)", data), "...have no names...");
  refuses("a.npy", array("'<f4'", "(1, 1, 3)", data, true), "...Fortran order...");
  refuses("a.npy", array("[('x', '<f4'), ('y', '<f4')]", "(1,)", data), "...no scalar property 'z'...");
  refuses("a.npy", array("[('a', '|V0')]", "(5,)", data), "...rows without bytes...");
  refuses("a.npy", array("'<f4'", "(1, 3)", bytes({1.f, std::numeric_limits<float>::quiet_NaN(), 2.f})), "read");
  std::string deep = "1";
  for (int k = 0; k < 100; ++k) deep = "(" + deep + ",)";
  refuses("a.npy", array("'<f4'", deep, data), "...too many brackets...");

  const std::string one = array("'<f4'", "(1, 3)", data), good = zip({{"points.npy", one, {}}});
  refuses("a.npz", good, "read");
  refuses("a.npz", "PK", "...not a ZIP archive...");
  refuses("a.npz", good.substr(0, good.size() - 1), "...ends before its list of members; it is truncated...");
  std::string flipped = good;
  flipped[good.find("NUMPY") + 120 - 70] ^= 1;
  refuses("a.npz", flipped, "...checksum...");
  refuses("a.npz", zip({{"points.npy", one, "\xff\xff\xff"}}), "...cannot be unpacked...");
  refuses("a.npz", zip({{"points.npy", std::string(100000, 'a'), "\x4b"}}), "...has an impossible size...");
  refuses("a.npz", good.substr(10), "...byte ...");
}

TEST_CASE("a written NPZ archive is read back unchanged, deflated where that is shorter") {
  PointCloud cloud;
  for (int i = 0; i < 3000; ++i) {
    cloud.positions.emplace_back(0.1f * static_cast<float>(i), 1 / 3.0f, static_cast<float>(i % 7));
    cloud.normals.emplace_back(0, 0, i % 2 == 0 ? 1 : -1);
    cloud.colors.push_back({static_cast<std::uint8_t>(i), 2, 3, static_cast<std::uint8_t>(i / 256)});
  }
  cloud.storedAs.alpha = true;
  for (const char* name : {"Colors_0", "weight"}) {
    Attribute& added = cloud.extra.emplace_back(Attribute{name, ScalarType::i32, {}});
    for (std::int32_t i = 0; i < 3000; ++i) {
      const auto* bytes = reinterpret_cast<const std::byte*>(&i);
      added.data.insert(added.data.end(), bytes, bytes + sizeof i);
    }
  }
  CHECK(npzFormat().lacks(cloud).empty());
  const ScratchFolder folder;
  writeCloud(folder / "a.npz", cloud);
  CHECK(std::filesystem::file_size(folder / "a.npz") < 3000 * 40 / 3);
  const PointCloud back = readCloud(folder / "a.npz").cloud;
  CHECK(back.positions == cloud.positions);
  CHECK(back.normals == cloud.normals);
  CHECK(back.colors == cloud.colors);
  REQUIRE(back.extra.size() == 2);
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(back.extra[k].name == cloud.extra[k].name);
    CHECK(back.extra[k].data == cloud.extra[k].data);
  }
  // Far from zero in double precision; a name with another meaning is reported as lost; no points.
  PointCloud far = reading(array("'<f8'", "(1, 3)", bytes({4500000.001, 5200000.002, 0.003}))).cloud;
  far.extra.push_back({"points", ScalarType::u8, std::vector<std::byte>(1)});
  CHECK(npzFormat().lacks(far) ==
        std::vector<std::string>{"the attribute 'points', because the archive uses its name"});
  writeCloud(folder / "b.npz", far);
  CHECK(readCloud(folder / "b.npz").cloud.fileCoordinates(0) == DVec3(4500000.001, 5200000.002, 0.003));
  CHECK(readCloud(folder / "b.npz").cloud.extra.empty());
  writeCloud(folder / "c.npz", {});
  CHECK(readCloud(folder / "c.npz").cloud.empty());
}

}  // namespace palpate::test::npy_format_test
