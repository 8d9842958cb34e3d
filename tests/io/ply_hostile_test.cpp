// Inconsistent, truncated or foreign files: each is refused with its line or byte, and none allocates memory for a
// wrong count.
#include <doctest/doctest.h>

#include <ctime>

#include "engine/core/error.hpp"
#include "engine/io/ply_reader.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/io/ply_bytes.hpp"

namespace palpate::test::ply_hostile_test {
namespace {

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

TEST_CASE("a file that is not PLY is refused") {
  refuses("", ":1: the file is empty...");
  refuses("solid cube", ":1: its first line is 'solid cube'; that of a PLY file is 'ply'...");
  refuses("plywood\n", "...its first line is 'plywood'...");
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
      CHECK(lost == std::vector<std::string>{"1 point without a finite position"});
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

}  // namespace palpate::test::ply_hostile_test
