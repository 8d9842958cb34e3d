// A triangle as glTF, made by hand for the tests of the reader.
#pragma once

#include <cstdint>
#include <string>

namespace palpate::test {

inline std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (at + k < bytes.size() ? static_cast<std::uint8_t>(bytes[at + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += at + k > bytes.size() ? '=' : kDigits[three >> (18 - 6 * k) & 63];
  }
  return out;
}

/// The corners (0, 0, 0), (1, 0, 0) and (0, 1, 0), scaled by two, at (10, 20, 30). `binary`: as GLB; otherwise as JSON
/// with an embedded buffer.
inline std::string gltfTriangle(bool binary) {
  std::string bin;
  for (const float value : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
    bin.append(reinterpret_cast<const char*>(&value), sizeof value);
  for (const std::uint16_t index : {0, 1, 2}) bin.append(reinterpret_cast<const char*>(&index), sizeof index);
  bin.resize(44, '\0');
  const std::string buffer =
      binary ? R"({"byteLength":44})" : R"({"byteLength":44,"uri":"data:;base64,)" + base64(bin) + "\"}";
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
      R"("nodes":[{"mesh":0,"translation":[10,20,30],"scale":[2,2,2]}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
      R"("buffers":[)" +
      buffer +
      R"(],"bufferViews":[{"buffer":0,"byteLength":36},)"
      R"({"buffer":0,"byteOffset":36,"byteLength":6}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},)"
      R"({"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}]})";
  if (!binary) return json;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string glb;
  const auto put = [&](std::uint32_t value) { glb.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(0x46546c67), put(2), put(static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + bin.size()));
  put(static_cast<std::uint32_t>(json.size())), put(0x4e4f534a);
  glb += json;
  put(static_cast<std::uint32_t>(bin.size())), put(0x004e4942);
  glb += bin;
  return glb;
}

}  // namespace palpate::test
