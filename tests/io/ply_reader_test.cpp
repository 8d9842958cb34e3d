// Reading PLY: every encoding gives the same cloud; inconsistent, truncated or foreign files are refused with their
// line or byte, and none allocates memory for a wrong count.
#include "engine/io/ply_reader.hpp"

#include <doctest/doctest.h>

#include <ctime>

#include "engine/core/error.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/io/ply_bytes.hpp"
#include "tests/near.hpp"

namespace palpate::test::ply_reader_test {

namespace {

template <class T>
T extraAt(const PointCloud& cloud, std::string_view name, std::size_t i) {
  for (const Attribute& attribute : cloud.extra)
    if (attribute.name == name) return loadScalar<T>(attribute.data.data() + i * sizeof(T));
  FAIL("no attribute ", std::string(name));
  return {};
}

/// Lists, other elements before and after the vertices, odd order, every type.
std::string everything(PlyFormat format) {
  using enum ScalarType;
  BodyWriter body(format);
  for (int face = 0; face < 2; ++face) body.put(u8, 3).put(i32, 0).put(i32, 1).put(i32, 1).put(f32, 0.5).endRow();
  for (int i = 0; i < 3; ++i) {
    body.put(u8, 10 + i).put(f64, i + 0.25).put(i16, -i).put(u16, 2).put(i32, 7).put(i32, 8).put(f32, 100 * i);
    body.put(i8, -i).put(u32, 4000000000.0 + i).put(u8, 20 + i).put(u8, 30 + i).endRow();
  }
  for (int edge = 0; edge < 2; ++edge) body.put(u32, 0).put(u32, 1).endRow();
  return magic(format) +
         "comment made by hand\n"
         "element face 2\nproperty list uchar int32 vertex_indices\nobj_info between\nproperty float quality\n"
         "element vertex 3\n"
         "property uint8 red\nproperty float64 z\nproperty int16 x\nproperty list ushort int ring\nproperty float32 "
         "intensity\n"
         "property int8 y\nproperty uint32 id\nproperty uchar green\ncomment late\nproperty uchar blue\n"
         "element edge 2\nproperty uint a\nproperty uint b\n"
         "end_header\n" +
         body.text();
}

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

std::string refusal(const std::string& text, PlyReadOptions options = {}) {
  const TemporaryFile file(text);
  std::string message = errorOf([&] { readPly(file.path(), nullptr, options); });
  const std::string name = file.path().string();
  if (message.starts_with(name)) message.erase(0, name.size());
  return message;
}

void refuses(const std::string& text, const std::string& expected, PlyReadOptions options = {}) {
  checkSaid(refusal(text, options), expected);
}

std::string floats(PlyFormat format, std::initializer_list<double> values) {
  BodyWriter body(format);
  for (const double value : values) body.put(ScalarType::f32, value);
  return body.text();
}

}  // namespace

TEST_CASE("every PLY encoding gives the same cloud, whatever surrounds the vertices") {
  for (const PlyFormat format : kAllFormats) {
    CAPTURE(plyName(format));
    const TemporaryFile file(everything(format));
    const PointCloud cloud = readPly(file.path());
    REQUIRE(cloud.size() == 3);
    CHECK(cloud.origin == DVec3(0));
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(cloud.positions[i] == Vec3(-static_cast<float>(i), -static_cast<float>(i), static_cast<float>(i) + 0.25f));
      CHECK(cloud.colors[i] ==
            std::array<std::uint8_t, 4>{std::uint8_t(10 + i), std::uint8_t(20 + i), std::uint8_t(30 + i), 255});
      CHECK(extraAt<float>(cloud, "intensity", i) == 100.0f * static_cast<float>(i));
      CHECK(extraAt<std::uint32_t>(cloud, "id", i) == 4000000000u + i);
    }
    CHECK(cloud.extra.size() == 2);
    CHECK_FALSE(cloud.hasNormals());
    CHECK(cloud.storedAs.comments ==
          std::vector<std::string>{"comment made by hand", "obj_info between", "comment late"});
  }
}

TEST_CASE("the PLY header alone gives the contents of a file") {
  const TemporaryFile file(everything(PlyFormat::binaryBigEndian));
  const PlyInfo info = readPlyInfo(file.path());
  CHECK(info.format == PlyFormat::binaryBigEndian);
  REQUIRE(info.elements.size() == 3);
  CHECK(info.elements[0].name == "face");
  CHECK(info.elements[1].count == 3);
  CHECK(info.elements[1].properties[1].type == ScalarType::f64);
  CHECK(info.elements[1].properties[3].isList);
  CHECK(info.elements[1].hasLists());
  CHECK(info.find("edge")->properties.size() == 2);
  CHECK(info.find("camera") == nullptr);
}

TEST_CASE("line ends may be LF and CRLF in one PLY header, also before a binary body") {
  for (const PlyFormat format : kAllFormats) {
    BodyWriter body(format);
    body.put(ScalarType::f32, 1).put(ScalarType::f32, 2).put(ScalarType::f32, 3).endRow();
    const TemporaryFile file(
        fmt::format("ply\r\nformat {} 1.0\nelement vertex 1\r\nproperty float x\nproperty float y\r\n\r\n"
                    "property float z  \r\nend_header\r\n",
                    plyName(format)) +
        body.text());
    CHECK(readPly(file.path()).positions.at(0) == Vec3(1, 2, 3));
  }
}

TEST_CASE("PLY lines may end with CR alone, in every encoding, and errors give the right line") {
  const std::string header = "element vertex 2\rproperty float x\rproperty float y\r\rproperty float z\rend_header\r";
  for (const PlyFormat format : kAllFormats) {
    BodyWriter body(format);
    for (const double value : {1, 2, 3, 4, 5, 6}) body.put(ScalarType::f32, value);
    std::string text = body.text();
    if (format == PlyFormat::ascii) text = "1 2 3\r\r4 5 6";  // the last line has no line end
    const TemporaryFile file(fmt::format("ply\rcomment one\rformat {} 1.0\r", plyName(format)) + header + text);
    const PointCloud cloud = readPly(file.path());
    CHECK(cloud.positions == std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
    CHECK(cloud.storedAs.comments == std::vector<std::string>{"comment one"});
  }
  const std::string ascii = "ply\rformat ascii 1.0\r";
  CHECK(contains(errorOf([&] { readPly(TemporaryFile(ascii + header + "1 2 3\r4 x 6\r").path()); }), ":10: found 'x'"));
  CHECK(contains(errorOf([&] { readPly(TemporaryFile(ascii + "element vertex -1\r").path()); }), ":3: the count"));
}

TEST_CASE("an LF after a PLY header of CR lines is data, unless the file is one byte too long for that") {
  const std::string header =
      "ply\rformat binary_little_endian 1.0\relement vertex 1\rproperty uchar x\rproperty uchar y\r"
      "property uchar z\rend_header\r";
  CHECK(readPly(TemporaryFile(header + "\n\x02\x03").path()).positions.at(0) == Vec3(10, 2, 3));
  CHECK(readPly(TemporaryFile(header + "\n\x01\x02\x03").path()).positions.at(0) == Vec3(1, 2, 3));
  // More than a byte too long: the remainder is not part of the cloud, and the header's line ends decide.
  CHECK(readPly(TemporaryFile(header + "\n\x02\x03junk").path()).positions.at(0) == Vec3(10, 2, 3));
  CHECK(contains(errorOf([&] { readPly(TemporaryFile(header + "\n\x02").path()); }), "truncated"));
}

TEST_CASE("a CR at the end of a read buffer is combined with the LF that follows") {
  for (const std::size_t length : {(std::size_t{1} << 20) - 2, (std::size_t{1} << 20) - 1, std::size_t{1} << 20}) {
    const std::string line(length, 'a');
    for (const std::string_view end : {"\r\n", "\r", "\n"}) {
      const TemporaryFile written(fmt::format("{}{}next{}", line, end, end));
      ChunkedFile file(written.path());
      CHECK(file.readLine(std::size_t{1} << 21) == line);
      CHECK(file.readLine(100) == "next");
      CHECK_FALSE(file.readLine(100));
      CHECK(file.linesEndWithCr() == (end == "\r"));
    }
  }
}

TEST_CASE("floating-point colours of PLY become bytes, and alpha is kept") {
  const TemporaryFile file(
      magic(PlyFormat::ascii) +
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float diffuse_red\n"
      "property float diffuse_green\nproperty float diffuse_blue\nproperty float alpha\nend_header\n"
      "0 0 0 0 0.5 1 0.2\n0 0 0 -1 2 nan 1\n0 0 0 1 1 1 1\n0 0 0 0.1 0.2 0.3 0\n");
  const PointCloud cloud = readPly(file.path());
  using Rgba = std::array<std::uint8_t, 4>;
  CHECK(cloud.colors[0] == Rgba{0, 128, 255, 51});
  CHECK(cloud.colors[1] == Rgba{0, 255, 0, 255});
  CHECK(cloud.extra.empty());
}

TEST_CASE("16-bit PLY colours are scaled to 8 bits, also with a floating-point alpha") {
  const TemporaryFile file(
      magic(PlyFormat::ascii) +
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty ushort red\n"
      "property ushort green\nproperty ushort blue\nproperty float alpha\nend_header\n0 0 0 65535 257 0 0.2\n");
  CHECK(readPly(file.path()).colors[0] == std::array<std::uint8_t, 4>{255, 1, 0, 51});
}

TEST_CASE("PLY coordinates far from the origin keep their precision") {
  for (const PlyFormat format : kAllFormats) {
    BodyWriter body(format);
    for (int i = 0; i < 100; ++i)
      body.put(ScalarType::f64, 500000.125 + 0.001 * i)
          .put(ScalarType::f64, 4.5e6)
          .put(ScalarType::f64, -0.001 * i)
          .endRow();
    const TemporaryFile file(
        magic(format) + "element vertex 100\nproperty double x\nproperty double y\nproperty double z\nend_header\n" +
        body.text());
    const PointCloud cloud = readPly(file.path());
    CHECK(cloud.origin.x == within(500000.1, 0.5));
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const DVec3 truth(500000.125 + 0.001 * static_cast<double>(i), 4.5e6, -0.001 * static_cast<double>(i));
      CHECK(glm::distance(cloud.origin + DVec3(cloud.positions[i]), truth) < 1e-8);
      CHECK(cloud.fileCoordinates(i) == truth);
    }
  }
}

TEST_CASE("the origin of a cloud is zero where single precision is sufficient") {
  CHECK(originFor({DVec3(-1), DVec3(1)}) == DVec3(0));
  CHECK(originFor({DVec3(10), DVec3(11)}) == DVec3(0));
  CHECK(originFor({DVec3(1000), DVec3(1001)}) == DVec3(1001));  // 1000.5 rounded to whole longest sides
  CHECK(originFor({DVec3(7), DVec3(7)}) == DVec3(7));
}

TEST_CASE("PLY normals are normalized, and unit ones stay unchanged") {
  const TemporaryFile file(
      magic(PlyFormat::ascii) +
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
      "property float ny\nproperty float nz\nend_header\n0 0 0 0 0 5\n1 0 0 0.6 0.8 0\n2 0 0 1e-30 0 0\n");
  const PointCloud cloud = readPly(file.path());
  CHECK(cloud.normals[0] == Vec3(0, 0, 1));
  CHECK(cloud.normals[1] == Vec3(0.6f, 0.8f, 0));
  CHECK(cloud.normals[2] == Vec3(1, 0, 0));
}

TEST_CASE("a few zero normals are taken from the nearest point; many leave the cloud without normals") {
  const std::string properties =
      "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float "
      "nz\nend_header\n";
  std::string rows;
  for (int i = 0; i < 20; ++i) rows += fmt::format("{} 0 0 0 {} {}\n", i, i < 10 && i != 4 ? 1 : 0, i < 10 ? 0 : 1);
  const TemporaryFile few(magic(PlyFormat::ascii) + "element vertex 20\n" + properties + rows);
  const PointCloud cloud = readPly(few.path());
  CHECK(cloud.normals.at(4) == Vec3(0, 1, 0));
  CHECK(cloud.normals.at(14) == Vec3(0, 0, 1));
  const TemporaryFile many(magic(PlyFormat::ascii) + "element vertex 2\n" + properties + "0 0 0 0 0 0\n1 0 0 0 0 1\n");
  CHECK_FALSE(readPly(many.path()).hasNormals());
}

TEST_CASE("PLY normals can be computed from faces and strips, before or after the vertices") {
  for (const PlyFormat format : kAllFormats) {
    for (const bool facesFirst : {false, true}) {
      for (const bool strips : {false, true}) {
        using enum ScalarType;
        BodyWriter faces(format), vertices(format);
        for (const int entry : strips ? std::vector{9, 0, 1, 3, 2, -1, 0, 1, 3, 2} : std::vector{4, 0, 1, 2, 3})
          faces.put(i32, entry);
        faces.endRow();
        for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}, {5, 5}})
          vertices.put(f32, x).put(f32, y).put(f32, 0).endRow();
        const std::string vertexHeader = "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n";
        const std::string faceHeader =
            fmt::format("element {} 1\nproperty list int int vertex_indices\n", strips ? "tristrips" : "face");
        const TemporaryFile file(magic(format) + (facesFirst ? faceHeader + vertexHeader : vertexHeader + faceHeader) +
                                 "end_header\n" +
                                 (facesFirst ? faces.text() + vertices.text() : vertices.text() + faces.text()));
        CHECK_FALSE(readPly(file.path()).hasNormals());
        const PointCloud cloud = readPly(file.path(), nullptr, {.normalsFromFaces = true});
        for (const Vec3& normal : cloud.normals) CHECK(normal == Vec3(0, 0, 1));
        CHECK(cloud.normals.size() == 5);
      }
    }
  }
}

TEST_CASE("a PLY file with no vertices is an empty cloud") {
  const TemporaryFile file(magic(PlyFormat::binaryLittleEndian) +
                           "element vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n");
  const PointCloud cloud = readPly(file.path());
  CHECK(cloud.empty());
  CHECK(boundsOf(cloud).longestSide() == 0);
}

TEST_CASE("PLY integers may be written as reals, and reals with a plus sign or below the smallest float") {
  const TemporaryFile file(
      magic(PlyFormat::ascii) +
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty uchar level\n"
      "end_header\n +1.5  1e-60 \t-2E+1 255.0\n");
  const PointCloud cloud = readPly(file.path());
  CHECK(cloud.positions[0] == Vec3(1.5f, 0, -20));
  CHECK(extraAt<std::uint8_t>(cloud, "level", 0) == 255);
}

TEST_CASE("a file that is not PLY is refused") {
  refuses("", ":1: the file is empty...");
  refuses("solid cube", ": is not a PLY file");
  refuses("plywood\n", ": is not a PLY file");
  refuses("version https://git-lfs.github.com/spec/v1\n", "...git lfs pull...");
  CHECK(contains(errorOf([] { readPly("/nowhere/at/all.ply"); }), "cannot be read"));
  CHECK(contains(errorOf([] { readPly("/tmp"); }), "is a folder"));
}

TEST_CASE("a broken PLY header is refused with its line") {
  const std::string ascii = "ply\nformat ascii 1.0\n";
  refuses("ply\nformat ascii 1.0\nelement vertex 1\n" + kXyz, ":6: the file ends inside the header...");
  refuses("ply\nelement vertex 0\n" + kXyz + "end_header\n", ":6: the header has no 'format' line...");
  refuses("ply\nformat utf8 1.0\n", ":2: format 'utf8' is unknown...");
  refuses("ply\nformat ascii 2.0\n", ":2: PLY version '2.0'...");
  refuses(ascii + "format ascii 1.0\n", ":3: a second 'format'...");
  refuses(ascii + "hello\n", ":3: 'hello' is not a header line...");
  refuses(ascii + "element vertex -1\n", ":3: the count of element 'vertex' is '-1'...");
  refuses(ascii + "element vertex 99999999999999999999\n", ":3: the count...");
  refuses(ascii + "element vertex 3.5\n", ":3: the count...");
  refuses(ascii + "element vertex\n", ":3: found 2 words...");
  refuses(ascii + "property float x\n", ":3: a property before the first element...");
  refuses(ascii + "element vertex 1\nproperty quad x\n", ":4: type 'quad' is unknown...");
  refuses(ascii + "element vertex 1\nproperty\n", ":4: found nothing after 'property'...");
  refuses(ascii + "element vertex 1\nproperty list float int x\n", ":4: a list cannot have 'float' items...");
  refuses(ascii + "element vertex 1\n" + kXyz + "property int x\n", ":7: a second property 'x'...");
  refuses(ascii + "element vertex 1\nelement vertex 1\n", ":4: a second element 'vertex'...");
  refuses(ascii + "element face 0\nend_header\n", "...no element 'vertex'; elements: face...");
  refuses(ascii + "element vertex 0\nproperty float x\nproperty float z\nend_header\n",
          ":3: the vertex element has no scalar property 'y'...");
  refuses("ply\n" + std::string(100000, 'x'), ":2: a line of more than...");
  std::string endless = ascii;
  while (endless.size() < 2'000'000) endless += "comment and so on\n";
  refuses(endless, "...no 'end_header' in the first...");
}

TEST_CASE("an impossible count in a PLY header costs neither time nor memory") {
  for (const PlyFormat format : kAllFormats) {
    for (const char* count : {"1000000000000000000", "18446744073709551615", "4294967296"}) {
      const std::clock_t begin = std::clock();  // processor time
      const std::string header = magic(format) + "element vertex " + count + "\n" + kXyz;
      refuses(header + "end_header\n" + floats(format, {1, 2, 3}), "...the file ends after...");
      refuses(header + "property list uint int n\nend_header\n", "...the file ends after...");
      const std::string faces =
          magic(format) + "element face " + count + "\nproperty list uchar int i\nelement vertex 1\n" + kXyz;
      refuses(faces + "end_header\n" + floats(format, {1, 2, 3}), "...the file ends after...");
      CHECK(std::clock() - begin < CLOCKS_PER_SEC);
    }
    // An element without properties has no bytes, whatever its count.
    refuses(magic(format) + "element nothing 18446744073709551615\nelement vertex 1\n" + kXyz + "end_header\n" +
                floats(format, {1, 2, 3}) + "\n",
            "");
  }
}

TEST_CASE("a PLY file cut off at any byte is refused or complete, without a crash") {
  for (const PlyFormat format : kAllFormats) {
    using enum ScalarType;
    BodyWriter body(format);
    for (int i = 0; i < 3; ++i)
      body.put(f32, i).put(f64, 2 * i * i).put(f32, 3 * i).put(u8, 2).put(i16, 5).put(i16, 6).endRow();
    body.put(u8, 3).put(i32, 0).put(i32, 1).put(i32, 2).endRow();
    const std::string text =
        magic(format) +
        "element vertex 3\nproperty float x\nproperty double y\nproperty float z\nproperty list uchar short ring\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
        body.text();
    refuses(text, "");
    for (std::size_t length = 0; length < text.size(); ++length) {
      const bool lastAsciiNumber =
          format == PlyFormat::ascii && length + 1 >= text.size();  // only the line's end is missing
      for (const bool faces : {false, true})
        CHECK((refusal(text.substr(0, length), {faces}) != "") == !lastAsciiNumber);
    }
  }
}

TEST_CASE("any damaged byte of a PLY file gives a cloud or an error") {
  using enum ScalarType;
  for (const PlyFormat format : kAllFormats) {
    BodyWriter body(format);
    for (int i = 0; i < 2; ++i) body.put(f32, i).put(f32, 2).put(f32, 3).put(u8, 1).put(i16, 5).endRow();
    body.put(u8, 3).put(i32, 0).put(i32, 1).put(i32, 1).endRow();
    const std::string text =
        magic(format) + "element vertex 2\n" + kXyz +
        "property list uchar short ring\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n" +
        body.text();
    const TemporaryFile file;
    for (std::size_t at = 0; at < text.size(); ++at) {
      for (const char damage : {'\0', '\xff', '9', ' ', '\n', '-'}) {
        std::string damaged = text;
        damaged[at] = damage;
        file.write(damaged);
        try {
          const PointCloud cloud = readPly(file.path(), nullptr, {.normalsFromFaces = at % 2 == 0});
          for (const Vec3& p : cloud.positions) CHECK(isFinite(p));
        } catch (const Error&) {
        }
      }
    }
  }
}

TEST_CASE("non-finite PLY positions are left out, and non-finite normals are treated as missing") {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const std::string head = "element vertex 3\n" + kXyz;
  for (const PlyFormat format : {PlyFormat::binaryLittleEndian, PlyFormat::binaryBigEndian}) {
    const std::string header = magic(format) + head + "end_header\n";
    for (const double bad : {nan, inf, -inf, 1e35}) {
      std::vector<std::string> lost;
      const TemporaryFile file(header + floats(format, {0, 0, 0, 1, 1, bad, 2, 2, 2}));
      const PointCloud cloud = readPly(file.path(), nullptr, {.lost = &lost});
      REQUIRE(cloud.size() == 2);
      CHECK(cloud.positions[1] == Vec3(2));
      CHECK(lost == std::vector<std::string>{"1 point without a finite position below 1e30"});
    }
    const std::string withNormals = magic(format) + "element vertex 1\n" + kXyz +
                                    "property float nx\nproperty float ny\nproperty float nz\nend_header\n";
    const TemporaryFile file(withNormals + floats(format, {0, 0, 0, 1, nan, 0}));
    CHECK_FALSE(readPly(file.path()).hasNormals());
  }
}

TEST_CASE("a PLY text row that does not match its properties is refused with its line") {
  const std::string head = magic(PlyFormat::ascii) + "element vertex 2\n" + kXyz + "property uchar level\n";
  refuses(head + "end_header\n0 0 0 1\n0 0 0\n", ":10: vertex 2 ends before 'level'...");
  refuses(head + "end_header\n0 0 0 1 5\n0 0 0 1\n",
          ":9: vertex 1 has more values than its 4 properties; found '5'...");
  refuses(head + "end_header\n0 0 0 1\n0 0,5 0 1\n",
          ":10: found '0,5' for 'y' of vertex 2, expected a number of type float...");
  refuses(head + "end_header\n0 0 0 256\n0 0 0 1\n", ":9: found '256' for 'level'...");
  refuses(head + "end_header\n0 0 0 -1\n0 0 0 1\n", ":9: found '-1' for 'level'...");
  refuses(head + "end_header\n0 0 0 1.5\n0 0 0 1\n", ":9: found '1.5' for 'level'...");
}

TEST_CASE("an impossible list length in PLY is refused") {
  const std::string lists = "element vertex 1\n" + kXyz + "property list int int ring\nend_header\n";
  refuses(magic(PlyFormat::ascii) + lists + "0 0 0 -1\n", ":9: vertex 1: list 'ring' claims -1 items...");
  refuses(magic(PlyFormat::ascii) + lists + "0 0 0 2000000000 1\n", ":9: vertex 1: list 'ring' claims 2000000000...");
  for (const PlyFormat format : {PlyFormat::binaryLittleEndian, PlyFormat::binaryBigEndian}) {
    for (const double length : {-1.0, 2147483647.0}) {
      BodyWriter body(format);
      body.put(ScalarType::f32, 0).put(ScalarType::f32, 0).put(ScalarType::f32, 0).put(ScalarType::i32, length);
      const std::string header = magic(format) + lists;
      refuses(header + body.text(),
              fmt::format(": byte {}: vertex 1: list 'ring' has {} items...", header.size() + 12, length));
    }
  }
}

TEST_CASE("PLY faces with invalid vertex indices are refused when they are used") {
  const std::string text =
      magic(PlyFormat::ascii) + "element vertex 3\n" + kXyz +
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 ";
  refuses(text + "3\n", "");
  refuses(text + "3\n", ":13: a face names vertex 3, but there are only 3...", {.normalsFromFaces = true});
  refuses(text + "-1\n", ":13: a face names vertex -1...", {.normalsFromFaces = true});
  refuses(magic(PlyFormat::ascii) + "element vertex 1\n" + kXyz + "end_header\n0 0 0\n", "...has no faces...",
          {.normalsFromFaces = true});
}

}  // namespace palpate::test::ply_reader_test
