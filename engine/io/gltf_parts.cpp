#include "engine/io/gltf_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace palpate {

namespace {

using Json = nlohmann::json;

constexpr unsigned kUint32 = 5125;

}  // namespace

const UnpackedMesh* GltfParts::unpacked(const Json& primitive) {
  const Json* packed = file_.extension(primitive, kDraco);
  if (!packed) return nullptr;
  const Json view = packed->value("bufferView", Json());
  const std::span<const std::byte> bytes = file_.view(view);
  const auto [found, isNew] = unpacked_.try_emplace(view.get<std::size_t>());
  if (!isNew) return &found->second;
  try {
    found->second = unpackMesh(bytes);
  } catch (const Error& error) {
    file_.fail(fmt::format("{}: {}", kDraco, error.what()));
  }
  return &found->second;
}

GltfNumbers GltfParts::attribute(const Json& primitive, const char* name, std::initializer_list<unsigned> perElement) {
  const Json& accessor = primitive["attributes"][name];
  const UnpackedMesh* mesh = unpacked(primitive);
  if (!mesh) return file_.numbers(accessor, perElement);
  const Json& packed = *file_.extension(primitive, kDraco);
  const Json ids = packed.value("attributes", Json::object());
  if (!ids.is_object() || !ids.contains(name)) return file_.numbers(accessor, perElement);
  const std::size_t id = file_.whole(ids, name, 0);
  const auto found =
      std::ranges::find_if(mesh->attributes, [&](const UnpackedMesh::Attribute& known) { return known.id == id; });
  GltfNumbers numbers = file_.described(file_.named("accessors", accessor), perElement);
  if (found == mesh->attributes.end() || found->perElement != numbers.perElement)
    file_.fail(fmt::format("{}: its data do not contain {} as stated", kDraco, name));
  numbers.kind = found->kind;
  numbers.data = found->bytes.data();
  numbers.stride = std::size_t{bytesOfGltfKind(found->kind)} * found->perElement;
  numbers.count = mesh->corners;
  return numbers;
}

std::optional<GltfNumbers> GltfParts::indices(const Json& primitive) {
  if (const UnpackedMesh* mesh = unpacked(primitive))
    return GltfNumbers{.data = reinterpret_cast<const std::byte*>(mesh->indices.data()),
                       .stride = sizeof(std::uint32_t),
                       .count = mesh->indices.size(),
                       .kind = kUint32,
                       .perElement = 1};
  if (!primitive.contains("indices")) return std::nullopt;
  return file_.numbers(primitive["indices"], {1});
}

}  // namespace palpate
