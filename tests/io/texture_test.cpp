// Colours of textures of OBJ, glTF and PLY, compared with an interpolation of the picture in double precision.
#include "engine/io/texture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "engine/io/gltf_parts.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/io/gltf_bytes.hpp"
#include "tests/png_bytes.hpp"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace palpate::test::texture_test {

namespace {

constexpr int kWidth = 4, kHeight = 3;

/// Neighbours of a pixel differ in each channel.
int channelOf(int x, int y, int channel) {
  return channel == 0 ? 60 * x + 20 : channel == 1 ? 90 * y + 10 : (x + y) % 2 == 0 ? 200 : 40;
}

std::string picture() {
  std::string rows;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int channel = 0; channel < 3; ++channel) rows += static_cast<char>(channelOf(x, y, channel));
  return pngBytes(kWidth, kHeight, 8, 2, rows);
}

int wrapped(int at, int size, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) return std::clamp(at, 0, size - 1);
  while (at < 0) at += 2 * size;
  if (wrap == TextureWrap::repeat) return at % size;
  at %= 2 * size;
  return at < size ? at : 2 * size - 1 - at;
}

struct Expected {
  TextureWrap wrap = TextureWrap::repeat;
  bool isSmooth = true;
  DVec3 factor{1};  // in linear light
  DVec2 shift{0};   // of coordinates, v from the top
  double tolerance = 1;

  /// `v` from the top.
  double at(double u, double v, int channel) const {
    u += shift.x, v += shift.y;
    const double x = u * kWidth - (isSmooth ? 0.5 : 0), y = v * kHeight - (isSmooth ? 0.5 : 0);
    const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
    double seen = 0;
    for (int dy = 0; dy < 2; ++dy)
      for (int dx = 0; dx < 2; ++dx) {
        const double share =
            isSmooth ? (dx ? x - left : 1 - (x - left)) * (dy ? y - top : 1 - (y - top)) : double(dx == 0 && dy == 0);
        seen += share * channelOf(wrapped(left + dx, kWidth, wrap), wrapped(top + dy, kHeight, wrap), channel);
      }
    if (factor[channel] == 1) return seen;
    const double light = seen / 255,
                 linear = factor[channel] * (light <= 0.04045 ? light / 12.92 : std::pow((light + 0.055) / 1.055, 2.4));
    return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
  }
};

/// Points of the unit square; their coordinates in the texture reach from -1 to 2, v from the bottom.
void checkColors(const PointCloud& cloud, const Expected& expected) {
  REQUIRE(cloud.size() > 0);
  REQUIRE(cloud.hasColors());
  double worst = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const DVec3 p = cloud.fileCoordinates(i);
    const double u = 3 * p.x - 1, v = 1 - (3 * p.y - 1);
    // A point on the border between two pixels belongs to either.
    const auto onBorder = [](double at) { return std::abs(at - std::round(at)) < 1e-4; };
    if (!expected.isSmooth && (onBorder(u * kWidth) || onBorder(v * kHeight))) continue;
    for (int channel = 0; channel < 3; ++channel)
      worst =
          std::max(worst, std::abs(expected.at(u, v, channel) - cloud.colors[i][static_cast<std::size_t>(channel)]));
  }
  CHECK(worst <= expected.tolerance);
}

class Files {
 public:
  Files& add(const std::string& name, const std::string& bytes) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return *this;
  }
  StoredCloud read(const std::string& name, const CloudReadOptions& options = {.samples = 3000}) const {
    return readCloud(folder_ / name, nullptr, options);
  }

 private:
  ScratchFolder folder_;
};

const std::string kCorners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt -1 -1\nvt 2 -1\nvt 2 2\nvt -1 2\n";
const std::string kFaces = "usemtl a\nf 1/1 2/2 3/3 4/4\n";

StoredCloud readObj(Files& files, const std::string& material, const std::string& corners = kCorners,
                    const std::string& faces = kFaces, const CloudReadOptions& options = {.samples = 3000}) {
  files.add("a.mtl", "newmtl a\n" + material).add("a.obj", "mtllib a.mtl\n" + corners + faces);
  return files.read("a.obj", options);
}

std::string named(const std::vector<std::string>& lost, std::string_view text) {
  const auto found = std::ranges::find_if(lost, [&](const std::string& what) { return what.find(text) != what.npos; });
  return found == lost.end() ? "" : *found;
}

/// The same square as glTF, whose v is from the top. `texture`, `sampler`, `image`: JSON.
std::string gltfSquare(const std::string& info, const std::string& sampler, const std::string& image,
                       const std::string& factor = "[1,1,1,1]", const std::string& attributes = "") {
  std::string bin;
  const auto put = [&](std::initializer_list<float> values) {
    for (const float value : values) bin.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  put({-1, 2, 2, 2, 2, -1, -1, -1});
  put({1, 0.5f, 0.25f, 1, 0.5f, 0.25f, 1, 0.5f, 0.25f, 1, 0.5f, 0.25f});
  for (const std::uint16_t index : {0, 1, 2, 0, 2, 3}) bin.append(reinterpret_cast<const char*>(&index), sizeof index);
  const std::string views =
      R"({"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":32},)"
      R"({"buffer":0,"byteOffset":80,"byteLength":48},{"buffer":0,"byteOffset":128,"byteLength":12},)"
      R"({"buffer":0,"byteOffset":140,"byteLength":)" +
      std::to_string(picture().size()) + "}";
  bin += picture();
  return R"({"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_1":1)" +
         attributes + R"(},"indices":3,"material":0}]}],"nodes":[{"mesh":0}],)" +
         R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":)" + factor + R"(,"baseColorTexture":)" + info +
         R"(}}],"textures":[{"source":0,"sampler":0}],"samplers":[)" + sampler + R"(],"images":[)" + image +
         R"(],"buffers":[{"byteLength":)" + std::to_string(bin.size()) + R"(,"uri":"data:;base64,)" + base64(bin) +
         R"("}],"bufferViews":[)" + views +
         R"(],"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
         R"({"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"},)"
         R"({"bufferView":2,"componentType":5126,"count":4,"type":"VEC3"},)"
         R"({"bufferView":3,"componentType":5123,"count":6,"type":"SCALAR"}]})";
}

const std::string kInfo = R"({"index":0,"texCoord":1})", kInView = R"({"bufferView":4,"mimeType":"image/png"})";

}  // namespace

TEST_CASE("OBJ: points have the colours of their texture") {
  Files files;
  files.add("a.png", picture());
  const StoredCloud grey = readObj(files, "Kd 0.8 0.8 0.8\nmap_Kd a.png\n");
  checkColors(grey.cloud, {});
  CHECK(named(grey.lost, "texture") == "");
  checkColors(readObj(files, "map_Kd -clamp on a.png\n").cloud, {.wrap = TextureWrap::clamp});
  checkColors(readObj(files, "map_Kd -blendu off -o 0.25 0.5 0 -s 1 1 1 -mm 0 1 a.png\n").cloud,
              {.shift = {0.25, -0.5}});
  // A colour that is not grey multiplies the texture.
  const double half = std::pow((128 / 255.0 + 0.055) / 1.055, 2.4);
  checkColors(readObj(files, "Kd 1 0.50196 1\nmap_Kd a.png\n").cloud, {.factor = {1, half, 1}, .tolerance = 2});
  // Corners, as a mesh is converted.
  checkColors(readObj(files, "map_Kd a.png\n", kCorners, kFaces, {.asTriangles = true}).cloud, {});
  // Names as other machines write them.
  files.add("maps/my picture.png", picture());
  checkColors(readObj(files, "map_Kd maps\\my picture.png\n").cloud, {});
  checkColors(readObj(files, "map_Kd C:\\scans\\of today\\a.png\n").cloud, {});
}

TEST_CASE("OBJ: a corner of two colours becomes two, and what a texture has between corners is named") {
  Files files;
  files.add("a.png", picture());
  const std::string two = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0.1 0.9\nvt 0.9 0.1\nvt 0.5 0.5\n";
  const StoredCloud mesh = readObj(files, "map_Kd a.png\n", two,
                                   "usemtl a\nf 1/1 2/1 3/1\nf 2/2 4/2 3/2\nf 1/1 2/1 4/3\n", {.asTriangles = true});
  REQUIRE(mesh.triangles.size() == 3);
  REQUIRE(mesh.cloud.hasColors());
  const auto colorAt = [&](std::size_t triangle, std::size_t k) {
    return mesh.cloud.colors[mesh.triangles[triangle][k]];
  };
  CHECK(mesh.cloud.size() == 7);
  for (std::size_t k = 1; k < 3; ++k) {
    CHECK(colorAt(0, k) == colorAt(0, 0));
    CHECK(colorAt(1, k) == colorAt(1, 0));
  }
  CHECK(colorAt(0, 0) != colorAt(1, 0));
  CHECK(mesh.triangles[2][1] == mesh.triangles[0][1]);
  CHECK(mesh.cloud.fileCoordinates(mesh.triangles[1][0]) == DVec3(1, 0, 0));
  CHECK(named(mesh.lost, "between") == "the colours of 1 texture between the corners");
}

TEST_CASE("OBJ: a texture that is not used is named with its reason") {
  Files files;
  files.add("a.png", picture()).add("text.png", "not a picture");
  const StoredCloud gone = readObj(files, "map_Kd gone.png\n");
  CHECK_FALSE(gone.cloud.hasColors());
  CHECK(named(gone.lost, "the colours of the texture 'gone.png' (") != "");
  CHECK(named(readObj(files, "map_Kd text.png\n").lost, "is neither a PNG nor a JPEG)") != "");
  const StoredCloud none = readObj(files, "map_Kd a.png\n", kCorners, "usemtl a\nf 1 2 3\n");
  CHECK(named(none.lost, "texture") == "the texture of 1 triangle without coordinates");
  CHECK_FALSE(none.cloud.hasColors());
  const StoredCloud some = readObj(files, "map_Kd a.png\n", kCorners, kFaces + "f 1 2 3\nf 1/9 2/9 3/9\n");
  CHECK(named(some.lost, "coordinates") == "the texture of 2 triangles without coordinates");
  const StoredCloud own = readObj(files, "map_Kd a.png\n",
                                  "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0 1 0 0\n" + kCorners.substr(32));
  CHECK(named(own.lost, "texture") == "the colours of the texture 'a.png' (corners have colours)");
  REQUIRE(own.cloud.hasColors());
  CHECK(own.cloud.colors[0] == Rgba{255, 0, 0, 255});
  // A triangle with a corner that is not finite takes its coordinates along.
  checkColors(
      readObj(files, "map_Kd a.png\n", "v 9 9 nan\n" + kCorners, "usemtl a\nf 1/1 2/1 3/1\nf 2/1 3/2 4/3 5/4\n").cloud,
      {});
}

TEST_CASE("OBJ: each material has its own texture, and a JPEG is read as a PNG is") {
  std::string jpeg;
  std::vector<std::uint8_t> smooth;
  for (int k = 0; k < 64 * 64; ++k)
    for (const int value : {2 * (k % 64), 3 * (k / 64), 90}) smooth.push_back(static_cast<std::uint8_t>(value));
  stbi_write_jpg_to_func(
      [](void* to, void* data, int size) {
        static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
      },
      &jpeg, 64, 64, 3, smooth.data(), 95);
  Files files;
  files.add("a.png", picture()).add("b.jpg", jpeg);
  const PointCloud cloud =
      readObj(files, "map_Kd a.png\nnewmtl b\nmap_Kd b.jpg\nnewmtl c\nKd 0 1 0\n",
              "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv 0 0 2\nv 1 0 2\nv 1 1 2\n" +
                  kCorners.substr(32) + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n",
              kFaces + "usemtl b\nf 5/5 6/6 7/7 8/8\nusemtl c\nf 9/1 10/2 11/3\n")
          .cloud;
  PointCloud first;
  double worst = 0;
  std::size_t green = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const DVec3 p = cloud.fileCoordinates(i);
    if (p.z < 0.5) {
      first.positions.push_back(cloud.positions[i]);
      first.colors.push_back(cloud.colors[i]);
    } else if (p.z < 1.5 && std::min({p.x, p.y, 1 - p.x, 1 - p.y}) > 0.02) {
      worst =
          std::max({worst, std::abs(cloud.colors[i][0] - 2 * (64 * p.x - 0.5)),
                    std::abs(cloud.colors[i][1] - 3 * (64 * (1 - p.y) - 0.5)), std::abs(cloud.colors[i][2] - 90.0)});
    } else {
      green += cloud.colors[i] == Rgba{0, 255, 0, 255};
    }
  }
  checkColors(first, {});
  CHECK(worst < 4);
  CHECK(green > 500);
}

TEST_CASE("glTF: points have the colours of textures in views, embedded or beside, by their samplers") {
  const auto reading = [](const std::string& json) { return readingFile("a.gltf", json, {.samples = 3000}).cloud; };
  checkColors(reading(gltfSquare(kInfo, "{}", kInView)), {});
  checkColors(reading(gltfSquare(kInfo, R"({"wrapS":33071,"wrapT":33071})", kInView)), {.wrap = TextureWrap::clamp});
  checkColors(reading(gltfSquare(kInfo, R"({"wrapS":33648,"wrapT":33648})", kInView)), {.wrap = TextureWrap::mirror});
  checkColors(reading(gltfSquare(kInfo, R"({"magFilter":9728})", kInView)), {.isSmooth = false});
  checkColors(reading(gltfSquare(kInfo, "{}", R"({"uri":"data:image/png;base64,)" + base64(picture()) + "\"}")), {});
  checkColors(reading(gltfSquare(kInfo, "{}", kInView, "[0.5,1,0.25,1]")), {.factor = {0.5, 1, 0.25}, .tolerance = 2});
  // Colours of corners multiply it, too.
  checkColors(reading(gltfSquare(kInfo, "{}", kInView, "[0.5,1,1,1]", R"(,"COLOR_0":2)")),
              {.factor = {0.5, 0.5, 0.25}, .tolerance = 2});
  const std::string moved = R"({"index":0,"extensions":{"KHR_texture_transform":{"texCoord":1,"offset":[0.25,-0.5]}}})";
  checkColors(reading(gltfSquare(moved, "{}", kInView)), {.shift = {0.25, -0.5}});
  Files files;
  files.add("my a.png", picture()).add("a.gltf", gltfSquare(kInfo, "{}", R"({"uri":"my%20a.png"})"));
  checkColors(files.read("a.gltf").cloud, {});
  checkColors(files.read("a.gltf", {.asTriangles = true}).cloud, {});
  files.add("b.gltf", gltfSquare(kInfo, "{}", R"({"uri":"gone.png"})"));
  const StoredCloud gone = files.read("b.gltf");
  CHECK_FALSE(gone.cloud.hasColors());
  CHECK(named(gone.lost, "the colours of the texture 'gone.png' (") != "");
  files.add("c.gltf", gltfSquare(R"({"index":7})", "{}", kInView));
  CHECK(named(files.read("c.gltf").lost, "the colours of the texture '7' (") != "");
  files.add("d.gltf", gltfSquare(R"({"index":0})", "{}", kInView));
  const StoredCloud none = files.read("d.gltf");
  CHECK(named(none.lost, "texture") == "the texture of 1 part without coordinates");
  CHECK_FALSE(none.cloud.hasColors());
}

TEST_CASE("glTF: the coordinates of a texture are scaled, rotated anticlockwise in the picture, and moved") {
  const GltfTexture quarter{.shift = {0.1, 0.2}, .scale = {2, 3}, .rotation_rad = 3.14159265358979323846 / 2};
  // To the right becomes up, and v is from the top.
  CHECK(glm::distance(quarter.transformed({1, 0}), Vec2(0.1f, 0.2f - 2)) < 1e-6f);
  CHECK(glm::distance(quarter.transformed({0, 1}), Vec2(0.1f + 3, 0.2f)) < 1e-6f);
}

TEST_CASE("PLY: points have the colours of the texture, by coordinates of vertices or of faces") {
  const auto square = [](bool byFace, const std::string& extra = "") {
    std::string text = "ply\nformat ascii 1.0\ncomment TextureFile a.png\n" + extra +
                       "element vertex 25\nproperty float x\nproperty float y\nproperty float z\n" +
                       (byFace ? "" : "property float s\nproperty float t\n") +
                       "element face 16\nproperty list uchar int vertex_indices\n" +
                       (byFace ? "property list uchar float texcoord\nproperty int texnumber\n" : "") + "end_header\n";
    const auto uv = [](int x, int y) { return fmt::format(" {} {}", 0.75 * x - 1, 0.75 * y - 1); };
    for (int k = 0; k < 25; ++k)
      text += fmt::format("{} {} 0{}\n", 0.25 * (k % 5), 0.25 * (k / 5), byFace ? "" : uv(k % 5, k / 5));
    for (int k = 0; k < 16; ++k) {
      const int x = k % 4, y = k / 4, first = 5 * y + x;
      text += fmt::format("4 {} {} {} {}", first, first + 1, first + 6, first + 5);
      if (byFace)
        text += " 8" + uv(x, y) + uv(x + 1, y) + uv(x + 1, y + 1) + uv(x, y + 1) + (extra.empty() ? " 0" : " 1");
      text += "\n";
    }
    return text;
  };
  Files files;
  files.add("a.png", picture()).add("a.ply", square(false)).add("b.ply", square(true));
  checkColors(files.read("a.ply").cloud, {});
  checkColors(files.read("b.ply").cloud, {});
  checkColors(files.read("b.ply", {.pointsOnly = true}).cloud, {});
  // The second of two textures.
  std::string two = square(true, "comment TextureFile a.png\n");
  files.add("c.ply", two.replace(two.find("a.png"), 5, "d.png")).add("d.png", "not a picture");
  const StoredCloud second = files.read("c.ply");
  checkColors(second.cloud, {});
  CHECK(named(second.lost, "the colours of the texture 'd.png' (") != "");
  CHECK(named(files.read("b.ply").lost, "texture") == "");
  files.add("b.ply", square(true).replace(square(true).find("a.png"), 5, "c.png"));
  const StoredCloud gone = files.read("b.ply");
  CHECK_FALSE(gone.cloud.hasColors());
  CHECK(named(gone.lost, "the colours of the texture 'c.png' (") != "");
}

}  // namespace palpate::test::texture_test
