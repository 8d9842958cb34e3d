// glTF that is compressed by Draco or meshoptimizer, written by the encoders of these libraries, and quantized glTF:
// the truth is the mesh before compression.
#include <doctest/doctest.h>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/io/file_cases.hpp"
#include "tests/io/gltf_bytes.hpp"

namespace palpate::test::gltf_packed_test {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

struct Mesh {
  std::vector<Vec3> corners, normals;
  std::vector<Triangle> triangles;
};

/// A torus of 24 by 16 corners, which lies within one unit.
Mesh torus() {
  constexpr std::uint32_t kAround = 24, kAcross = 16;
  constexpr double kPi = 3.14159265358979323846;
  Mesh mesh;
  for (std::uint32_t i = 0; i < kAround; ++i)
    for (std::uint32_t j = 0; j < kAcross; ++j) {
      const double a = 2 * kPi * i / kAround, b = 2 * kPi * j / kAcross;
      const DVec3 normal(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b));
      mesh.normals.emplace_back(normal);
      mesh.corners.emplace_back(0.35 * DVec3(std::cos(a), std::sin(a), 0) + 0.12 * normal + DVec3(0.5));
      const auto at = [&](std::uint32_t x, std::uint32_t y) { return x % kAround * kAcross + y % kAcross; };
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

/// The bytes and views of a buffer.
struct Buffer {
  std::string bytes, views;

  /// Returns the number of the view. `stride`: also stated by the view, if it is not 0.
  int add(const std::string& data, std::size_t stride = 0) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    addView(fmt::format(R"({{"buffer":0,"byteOffset":{},"byteLength":{}{}}})", bytes.size(), data.size(),
                        stride > 0 ? fmt::format(R"(,"byteStride":{})", stride) : ""));
    bytes += data;
    return count_ - 1;
  }
  int addPacked(const std::vector<unsigned char>& data, std::size_t count, std::size_t stride, const char* mode,
                const char* filter = "NONE") {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    addView(fmt::format(
        R"({{"buffer":1,"byteLength":{}{},"extensions":{{"EXT_meshopt_compression":{{"buffer":0,"byteOffset":{},)"
        R"("byteLength":{},"byteStride":{},"count":{},"mode":"{}","filter":"{}"}}}}}})",
        count * stride, mode == std::string_view("ATTRIBUTES") ? fmt::format(R"(,"byteStride":{})", stride) : "",
        bytes.size(), data.size(), stride, count, mode, filter));
    bytes.append(data.begin(), data.end());
    return count_ - 1;
  }

 private:
  void addView(const std::string& view) {
    views += (count_ > 0 ? "," : "") + view;
    ++count_;
  }
  int count_ = 0;
};

template <class T>
std::string bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// `part`: what a primitive has beside its attributes. `required`: name of an extension.
std::string gltf(const Buffer& buffer, const std::string& accessors, const std::string& part,
                 const std::string& required, const std::string& node = "") {
  return R"({"asset":{"version":"2.0"},"extensionsRequired":[")" + required +
         R"("],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1})" + part +
         R"(}]}],"nodes":[{"mesh":0)" + node + R"(}],"buffers":[{"byteLength":)" + std::to_string(buffer.bytes.size()) +
         R"(,"uri":"data:;base64,)" + base64(buffer.bytes) +
         R"("},{"byteLength":99999,"extensions":{"EXT_meshopt_compression":{"fallback":true}}}],"bufferViews":[)" +
         buffer.views + R"(],"accessors":[)" + accessors + "]}";
}

std::string accessor(int view, int componentType, std::size_t count, const char* type, bool normalized = false) {
  return fmt::format(R"({{"bufferView":{},"componentType":{},"count":{},"type":"{}","normalized":{}}})", view,
                     componentType, count, type, normalized);
}

/// The triangles by their corners in the truth, each from its smallest corner on.
std::set<Triangle> asIn(const Mesh& truth, const StoredCloud& stored, double tolerance, double degrees) {
  REQUIRE(stored.cloud.hasNormals());
  std::vector<std::uint32_t> same;
  double farthest = 0, steepest = 0;
  for (std::size_t i = 0; i < stored.cloud.size(); ++i) {
    const Vec3 p(stored.cloud.fileCoordinates(i));
    const auto nearest =
        std::ranges::min_element(truth.corners, {}, [&](const Vec3& q) { return glm::distance(p, q); });
    same.push_back(static_cast<std::uint32_t>(nearest - truth.corners.begin()));
    farthest = std::max(farthest, double(glm::distance(p, *nearest)));
    steepest = std::max(steepest, angleBetween_deg(DVec3(truth.normals[same.back()]), DVec3(stored.cloud.normals[i])));
  }
  CHECK(farthest <= tolerance);
  CHECK(steepest <= degrees);
  std::set<Triangle> triangles;
  for (const Triangle& triangle : stored.triangles) {
    Triangle known{same[triangle[0]], same[triangle[1]], same[triangle[2]]};
    std::ranges::rotate(known, std::ranges::min_element(known));
    triangles.insert(known);
  }
  return triangles;
}

void checkSame(const std::string& json, double tolerance, double degrees) {
  const Mesh truth = torus();
  std::set<Triangle> expected;
  for (Triangle triangle : truth.triangles) {
    std::ranges::rotate(triangle, std::ranges::min_element(triangle));
    expected.insert(triangle);
  }
  const StoredCloud stored = readingFile("a.gltf", json, {.asTriangles = true});
  CHECK(stored.cloud.size() == truth.corners.size());
  CHECK(asIn(truth, stored, tolerance, degrees) == expected);
}

std::string dracoBytes(int method) {
  const Mesh mesh = torus();
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(mesh.triangles.size()));
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32),
            normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    const draco::FaceIndex face(static_cast<std::uint32_t>(t));
    builder.SetAttributeValuesForFace(position, face, &mesh.corners[a], &mesh.corners[b], &mesh.corners[c]);
    builder.SetAttributeValuesForFace(normal, face, &mesh.normals[a], &mesh.normals[b], &mesh.normals[c]);
  }
  const std::unique_ptr<draco::Mesh> made = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 12);
  draco::EncoderBuffer buffer;
  REQUIRE(encoder.EncodeMeshToBuffer(*made, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

/// Accessors of a mesh that Draco compressed state no views.
std::string dracoGltf(const std::string& bytes, const std::string& attributes = R"("POSITION":0,"NORMAL":1)") {
  Buffer buffer;
  buffer.add(bytes);
  const std::string corners = R"({"componentType":5126,"count":384,"type":"VEC3"})";
  return gltf(
      buffer, corners + "," + corners + R"(,{"componentType":5123,"count":2304,"type":"SCALAR"})",
      R"(,"indices":2,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{)" + attributes + "}}}",
      "KHR_draco_mesh_compression");
}

template <class T>
std::vector<unsigned char> packed(const std::vector<T>& values) {
  std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(values.size(), sizeof(T)));
  bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), values.data(), values.size(), sizeof(T)));
  return bytes;
}

std::vector<std::uint32_t> indicesOf(const Mesh& mesh) {
  std::vector<std::uint32_t> indices;
  for (const Triangle& triangle : mesh.triangles) indices.insert(indices.end(), triangle.begin(), triangle.end());
  return indices;
}

std::vector<unsigned char> packedTriangles(const Mesh& mesh) {
  const std::vector<std::uint32_t> indices = indicesOf(mesh);
  std::vector<unsigned char> bytes(meshopt_encodeIndexBufferBound(indices.size(), mesh.corners.size()));
  bytes.resize(meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), indices.data(), indices.size()));
  return bytes;
}

std::string meshoptGltf(const Buffer& buffer, const std::string& position, const std::string& normal, int indices,
                        const std::string& node = "") {
  return gltf(buffer, position + "," + normal + "," + accessor(indices, 5125, 2304, "SCALAR"), R"(,"indices":2)",
              "EXT_meshopt_compression", node);
}

}  // namespace

TEST_CASE("glTF that Draco compressed gives the mesh before compression, within its quantization") {
  for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING}) {
    CAPTURE(method);
    checkSame(dracoGltf(dracoBytes(method)), 1.0 / 16384, 0.3);
  }
  const StoredCloud points =
      readingFile("a.gltf", dracoGltf(dracoBytes(draco::MESH_EDGEBREAKER_ENCODING)), {.samples = 5000});
  CHECK(points.cloud.size() == 5000);
}

TEST_CASE("glTF that Draco compressed is refused by name if its data are damaged, or lack an attribute") {
  const std::string bytes = dracoBytes(draco::MESH_EDGEBREAKER_ENCODING);
  refuses("a.gltf", dracoGltf(bytes.substr(0, bytes.size() / 2)),
          ": KHR_draco_mesh_compression: its data are damaged...");
  refuses("a.gltf", dracoGltf("DRACO"), ": KHR_draco_mesh_compression: its data are damaged...");
  refuses("a.gltf", dracoGltf(bytes, R"("POSITION":7,"NORMAL":1)"),
          ": KHR_draco_mesh_compression: its data do not contain POSITION as stated");
  std::size_t refused = 0;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::string damaged = bytes;
    damaged[k] = static_cast<char>(damaged[k] ^ 0x55);
    refused += refusalOf("a.gltf", dracoGltf(damaged)) != "read";  // or another mesh: Draco has no checksums
  }
  CHECK(refused > 0);
}

TEST_CASE("glTF that meshoptimizer compressed gives the mesh before compression") {
  const Mesh mesh = torus();
  const std::size_t count = mesh.corners.size();
  {
    Buffer buffer;
    const int corners = buffer.addPacked(packed(mesh.corners), count, 12, "ATTRIBUTES"),
              normals = buffer.addPacked(packed(mesh.normals), count, 12, "ATTRIBUTES"),
              triangles = buffer.addPacked(packedTriangles(mesh), 2304, 4, "TRIANGLES");
    checkSame(
        meshoptGltf(buffer, accessor(corners, 5126, count, "VEC3"), accessor(normals, 5126, count, "VEC3"), triangles),
        0, 1e-3);
  }
  {  // Exponential and octahedral filters, and indices in a sequence.
    std::vector<std::array<std::int32_t, 3>> exponential(count);
    meshopt_encodeFilterExp(exponential.data(), count, 12, 15, &mesh.corners[0].x);
    std::vector<Vec4> four;
    for (const Vec3& normal : mesh.normals) four.emplace_back(normal, 0);
    std::vector<std::array<std::int8_t, 4>> octahedral(count);
    meshopt_encodeFilterOct(octahedral.data(), count, 4, 8, &four[0].x);
    const std::vector<std::uint32_t> indices = indicesOf(mesh);
    std::vector<unsigned char> sequence(meshopt_encodeIndexSequenceBound(indices.size(), count));
    sequence.resize(meshopt_encodeIndexSequence(sequence.data(), sequence.size(), indices.data(), indices.size()));
    Buffer buffer;
    const int corners = buffer.addPacked(packed(exponential), count, 12, "ATTRIBUTES", "EXPONENTIAL"),
              normals = buffer.addPacked(packed(octahedral), count, 4, "ATTRIBUTES", "OCTAHEDRAL"),
              triangles = buffer.addPacked(sequence, indices.size(), 4, "INDICES");
    checkSame(meshoptGltf(buffer, accessor(corners, 5126, count, "VEC3"), accessor(normals, 5120, count, "VEC3", true),
                          triangles),
              1.0 / 8192, 1.5);
  }
}

TEST_CASE("glTF that meshoptimizer compressed is refused by name if its data are damaged") {
  const Mesh mesh = torus();
  const auto with = [&](const std::vector<unsigned char>& corners, std::size_t count, std::size_t stride,
                        const char* mode, const char* filter = "NONE") {
    Buffer buffer;
    buffer.addPacked(corners, count, stride, mode, filter);
    const int triangles = buffer.addPacked(packedTriangles(mesh), 2304, 4, "TRIANGLES");
    return meshoptGltf(buffer, accessor(0, 5126, 384, "VEC3"), accessor(0, 5126, 384, "VEC3"), triangles);
  };
  const std::vector<unsigned char> bytes = packed(mesh.corners);
  const std::string is = ": EXT_meshopt_compression: ";
  CHECK(refusalOf("a.gltf", with(bytes, 384, 12, "ATTRIBUTES")) == "read");
  refuses("a.gltf", with({bytes.begin(), bytes.end() - 9}, 384, 12, "ATTRIBUTES"), is + "its data are damaged");
  refuses("a.gltf", with(bytes, 384, 13, "ATTRIBUTES"), is + "elements of 13 bytes, mode 'ATTRIBUTES'...");
  refuses("a.gltf", with(bytes, 384, 12, "OTHERS"), is + "elements of 12 bytes, mode 'OTHERS'...");
  refuses("a.gltf", with(bytes, 384, 12, "ATTRIBUTES", "OCTAHEDRAL"), is + "elements of 12 bytes...");
  refuses("a.gltf", with(bytes, 385, 2, "TRIANGLES"), is + "elements of 2 bytes...");
  refuses("a.gltf", with(bytes, std::size_t{1} << 60, 12, "ATTRIBUTES"), is + "1152921504606846976 elements...");
}

TEST_CASE("glTF with quantized attributes gives the mesh before quantization, within its steps") {
  const Mesh mesh = torus();
  const std::size_t count = mesh.corners.size();
  for (const bool normalized : {false, true}) {
    CAPTURE(normalized);
    std::vector<std::array<std::uint16_t, 4>> corners;
    std::vector<std::array<std::int8_t, 4>> normals;
    for (std::size_t i = 0; i < count; ++i) {
      auto& corner = corners.emplace_back();
      auto& normal = normals.emplace_back();
      for (int k = 0; k < 3; ++k) {
        corner[static_cast<std::size_t>(k)] = static_cast<std::uint16_t>(std::lround(mesh.corners[i][k] * 65535));
        normal[static_cast<std::size_t>(k)] = static_cast<std::int8_t>(std::lround(mesh.normals[i][k] * 127));
      }
    }
    Buffer buffer;
    const int at = buffer.add(bytesOf(corners), 8), facing = buffer.add(bytesOf(normals), 4),
              triangles = buffer.add(bytesOf(indicesOf(mesh)));
    const std::string scale =
        normalized ? "" : R"(,"scale":[1.5259021896696422e-5,1.5259021896696422e-5,1.5259021896696422e-5])";
    checkSame(gltf(buffer,
                   accessor(at, 5123, count, "VEC3", normalized) + "," + accessor(facing, 5120, count, "VEC3", true) +
                       "," + accessor(triangles, 5125, 2304, "SCALAR"),
                   R"(,"indices":2)", "KHR_mesh_quantization", scale),
              1.4e-5, 0.6);
  }
}

}  // namespace palpate::test::gltf_packed_test
