// The reader of glTF: buffers, nodes, instances, colours, extensions, and errors.
#include <glm/geometric.hpp>

#include "tests/io/gltf_bytes.hpp"
#include "tests/io/mesh_texts.hpp"
#include "tests/near.hpp"

namespace palpate::test::gltf_import_test {

using namespace mesh_texts;

TEST_CASE("glTF: instances of a mesh are placed, and an extension that a file requires is known or named") {
  const std::string json = gltfTriangle(false);
  const std::string node = R"({"mesh":0,"translation":[10,20,30],"scale":[2,2,2]})";
  // The three corners as places of instances.
  const std::string instances =
      replaced(json, node,
               node.substr(0, node.size() - 1) +
                   R"(,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}})");
  const TriangleSoup soup =
      imported(importGltf,
               replaced(instances, "{\"asset\"", R"({"extensionsRequired":["EXT_mesh_gpu_instancing"],"asset")"))
          .soup;
  REQUIRE(soup.triangles.size() == 3);
  CHECK(soup.corners.at(0) == DVec3(10, 20, 30));
  CHECK(soup.corners.at(3) == DVec3(12, 20, 30));
  CHECK(soup.corners.at(7) == DVec3(12, 22, 30));
  const TriangleSoup scaled = imported(importGltf, replaced(instances, "\"TRANSLATION\"", "\"SCALE\"")).soup;
  CHECK(scaled.corners.at(4) == DVec3(12, 20, 30));
  refuses(importGltf, replaced(instances, "\"TRANSLATION\":0", "\"ROTATION\":0"), "...a type that its use...");
  refuses(importGltf, replaced(json, "{\"asset\"", R"({"extensionsRequired":["EXT_mesh_future"],"asset")"),
          ": requires the extension EXT_mesh_future, which is not read...");
  CHECK(imported(importGltf, replaced(json, "{\"asset\"", R"({"extensionsRequired":["KHR_materials_unlit"],"asset")"))
            .soup.triangles.size() == 1);
  CHECK(imported(importGltf, replaced(json, "{\"asset\"", R"({"extensionsUsed":["KHR_gaussian_splatting"],"asset")"))
            .lost == std::vector<std::string>{"the shapes of Gaussians (KHR_gaussian_splatting)"});
}

TEST_CASE("glTF: base colours of materials become those of corners") {
  const std::string json = gltfTriangle(false);
  const auto with = [&](const std::string& surface) {
    return imported(importGltf, replaced(replaced(json, R"("indices":1)", R"("indices":1,"material":0)"), "{\"asset\"",
                                         R"({"materials":[{"pbrMetallicRoughness":)" + surface + R"(}],"asset")"));
  };
  const ImportedMesh red = with(R"({"baseColorFactor":[1,0,0.2158605,1]})");  // linear light
  REQUIRE(red.soup.colors.size() == 3);
  CHECK(red.soup.colors[1] == std::array<std::uint8_t, 4>{255, 0, 128, 255});
  CHECK(red.lost.empty());
  CHECK(with(R"({"baseColorFactor":[0.5,0.5,0.5,1]})").soup.colors.empty());
}

TEST_CASE("glTF: a buffer embedded, beside the file or in GLB gives the same mesh") {
  const ImportedMesh packed = imported(importGltf, gltfTriangle(true)),
                     text = imported(importGltf, gltfTriangle(false));
  CHECK(packed.soup.corners == std::vector<DVec3>{{10, 20, 30}, {12, 20, 30}, {10, 22, 30}});
  CHECK(text.soup.corners == packed.soup.corners);
  CHECK(text.soup.triangles == packed.soup.triangles);
  const ScratchFolder folder;
  const std::string glb = gltfTriangle(true), json = gltfTriangle(false);
  const std::size_t data = json.find("data:"), end = json.find('"', data);
  std::ofstream(folder / "a b.bin", std::ios::binary) << glb.substr(glb.size() - 44);
  std::ofstream(folder / "a.gltf") << std::string(json).replace(data, end - data, "a%20b.bin");
  CHECK(importGltf(folder / "a.gltf").soup.corners == packed.soup.corners);
  for (const char* elsewhere : {"../b.bin", "/etc/passwd", "http://a/b.bin", ""})
    refuses(importGltf, std::string(json).replace(data, end - data, elsewhere),
            "...not the name of a file beside this one...");
  refuses(importGltf, std::string(json).replace(data, end - data, "gone.bin"),
          ": buffer 0 is 'gone.bin', and there is no such file beside this one");
}

TEST_CASE("glTF: nodes rotate, mirror and repeat a mesh, and triangle strips and fans are read") {
  const std::string json = gltfTriangle(false);
  const auto with = [&](const std::string& what, const std::string& instead) {
    return imported(importGltf, replaced(json, what, instead)).soup;
  };
  const std::string node = R"({"mesh":0,"translation":[10,20,30],"scale":[2,2,2]})";
  const auto normalOf = [](const TriangleSoup& soup) {
    const auto [a, b, c] = soup.triangles.at(0);
    return glm::normalize(glm::cross(soup.corners[b] - soup.corners[a], soup.corners[c] - soup.corners[a]));
  };
  const TriangleSoup mirrored = with(node, R"({"mesh":0,"scale":[-1,1,1]})");
  CHECK(glm::distance(normalOf(mirrored), DVec3(0, 0, 1)) < 1e-12);
  const TriangleSoup turned = with(node, R"({"mesh":0,"rotation":[0.7071067811865476,0,0,0.7071067811865476]})");
  CHECK(glm::distance(normalOf(turned), DVec3(0, -1, 0)) < 1e-12);
  const TriangleSoup placed = with(node, R"({"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1]})");
  CHECK(placed.corners.at(1) == DVec3(6, 6, 7));
  const TriangleSoup nested =
      with(node, R"({"children":[1,2],"translation":[1,0,0]},{"mesh":0},{"mesh":0,"scale":[3,3,3]})");
  CHECK(nested.triangles.size() == 2);
  CHECK(nested.corners.at(4) == DVec3(4, 0, 0));
  for (const int mode : {5, 6})
    CHECK(with(R"("indices":1)", R"("indices":1,"mode":)" + std::to_string(mode)).triangles.size() == 1);
  const ImportedMesh lines = imported(importGltf, replaced(json, R"("indices":1)", R"("indices":1,"mode":1)"));
  CHECK(lines.soup.triangles.empty());
  CHECK(lines.lost == std::vector<std::string>{"3 points and lines"});
  // The corners as normals, and as colours: the second is red, the third green.
  const TriangleSoup dressed = with(R"("POSITION":0)", R"("POSITION":0,"NORMAL":0,"COLOR_0":0)");
  REQUIRE(dressed.colors.size() == 3);
  CHECK(dressed.colors[1] == std::array<std::uint8_t, 4>{255, 0, 0, 255});
  REQUIRE(dressed.normals.size() == 3);
  CHECK(glm::normalize(dressed.normals[2]) == Vec3(0, 1, 0));
}

TEST_CASE("glTF: accessors beyond their buffer, cyclic nodes and compressed meshes are refused") {
  const std::string json = gltfTriangle(false);
  const auto why = [&](const std::string& what, const std::string& instead, const char* expected) {
    refuses(importGltf, replaced(json, what, instead), expected);
  };
  why(R"("count":3,"type":"VEC3")", R"("count":4,"type":"VEC3")", "...an accessor of 4 elements...");
  why(R"("count":3,"type":"VEC3")", R"("count":18446744073709551615,"type":"VEC3")",
      "...an accessor of 18446744073709551615...");
  why(R"("byteLength":36})", R"("byteLength":45})", "...a view of 45 bytes from byte 0 on exceeds its buffer of 44...");
  why(R"("byteLength":36})", R"("byteLength":36,"byteStride":4})", "...a stride of 4 bytes...");
  why(R"("byteOffset":36)", R"("byteOffset":-1)", "...not a whole number of 0 or more...");
  why(R"("componentType":5126)", R"("componentType":5130)", "...a type that its use does not allow...");
  why(R"("componentType":5123)", R"("componentType":5122)", "...data of corners have a type...");
  why(R"("bufferView":0,"componentType")", R"("sparse":{},"componentType")", "...sparse...");
  why(R"("mesh":0)", R"("mesh":7)", "...\"meshes\" has 1 elements; '7' is out of range...");
  why(R"("mesh":0)", R"("children":[0],"mesh":0)", "...node 0 is a duplicate...");
  why(R"("version":"2.0"})", R"("version":"1.0"})", "...is glTF '1.0'...");
  // Each is named, whether its library is built in or not.
  why(R"("indices":1)", R"("indices":1,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0}})",
      ": KHR_draco_mesh_compression: ...");
  why(R"("byteLength":36})",
      R"("byteLength":36,"extensions":{"EXT_meshopt_compression":{"buffer":0,"byteLength":36,"mode":"ATTRIBUTES"}}})",
      ": EXT_meshopt_compression: ...");
  why(R"("scale":[2,2,2])", R"("scale":[2,2])", "...not a list of 3 numbers...");
  refuses(importGltf, json.substr(0, 100), "...: byte 101: the file ends inside its JSON...");
  refuses(importGltf, "[]", "...: byte 0: ...");
  const std::string glb = gltfTriangle(true);
  refuses(importGltf, glb.substr(0, 10), ": byte 10: the file ends within its header");
  refuses(importGltf, glb.substr(0, glb.size() - 1), "...the file ends after ...");
  std::string longer = glb;
  longer[13] = '\xff';
  refuses(importGltf, longer, "...: byte 12: a part of ...");
  // A triangle with a missing corner: the indices are the last bytes.
  std::string corner = glb;
  corner[corner.size() - 4] = 9;
  refuses(importGltf, corner, "...a triangle refers to corner 9, counted from 0, but there are only 3...");
}

TEST_CASE("points of glTF are read as points") {
  std::string gltf = gltfTriangle(false);
  const std::size_t mode = gltf.find("\"attributes\"");
  REQUIRE(mode != std::string::npos);
  CHECK(readingFile("a.gltf", std::string(gltf).insert(mode, "\"mode\":0,")).cloud.size() == 3);
}

}  // namespace palpate::test::gltf_import_test
