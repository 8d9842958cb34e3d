#include "engine/io/gltf_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace palpate {

namespace {

using Json = nlohmann::json;

TextureWrap wrapOf(std::size_t number) {
  constexpr std::size_t kClamp = 33071, kMirror = 33648;
  return number == kClamp ? TextureWrap::clamp : number == kMirror ? TextureWrap::mirror : TextureWrap::repeat;
}

DVec2 pairIn(const Json& object, const char* name, const DVec2& otherwise) {
  const auto found = object.find(name);
  const bool isPair = found != object.end() && found->is_array() && found->size() == 2 && (*found)[0].is_number() &&
                      (*found)[1].is_number();
  return isPair ? DVec2((*found)[0].get<double>(), (*found)[1].get<double>()) : otherwise;
}

using Json = nlohmann::json;

constexpr unsigned kUint32 = 5125;

}  // namespace

Vec2 GltfTexture::transformed(const DVec2& uv) const {
  const DVec2 scaled = uv * scale;
  const double c = std::cos(rotation_rad), s = std::sin(rotation_rad);
  return Vec2(DVec2(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x) + shift);
}

std::optional<GltfTexture> GltfTextures::of(const Json& stated) {
  if (!stated.is_object()) file_.fail("\"baseColorTexture\" is not an object");
  const std::size_t which = file_.whole(stated, "index", 0);
  const auto [found, isNew] = numbers_.try_emplace(which, kNoTexture);
  if (isNew) found->second = numberOf(which);
  if (found->second == kNoTexture) return std::nullopt;
  GltfTexture use{.number = found->second};
  std::size_t coordinates = file_.whole(stated, "texCoord", 0);
  if (const Json* transform = file_.extension(stated, "KHR_texture_transform")) {
    coordinates = file_.whole(*transform, "texCoord", coordinates);
    use.shift = pairIn(*transform, "offset", use.shift);
    use.scale = pairIn(*transform, "scale", use.scale);
    const auto rotation = transform->find("rotation");
    if (rotation != transform->end() && rotation->is_number()) use.rotation_rad = rotation->get<double>();
  }
  use.coordinates = fmt::format("TEXCOORD_{}", coordinates);
  return use;
}

std::uint32_t GltfTextures::numberOf(std::size_t which) {
  Texture made{.file = file_.path(), .bytes = {}, .name = fmt::format("{}", which)};
  try {
    const Json& texture = file_.named("textures", which);
    if (!texture.contains("source")) file_.fail("it is neither PNG nor JPEG");
    const Json& image = file_.named("images", texture["source"]);
    for (const char* name : {"name", "uri"})
      if (const auto known = image.find(name); known != image.end() && known->is_string())
        if (const std::string text = *known; !text.empty() && !text.starts_with("data:")) made.name = text;
    made.bytes = file_.picture(texture["source"]);
    if (texture.contains("sampler")) {
      constexpr std::size_t kRepeat = 10497, kNearest = 9728, kLinear = 9729;
      const Json& sampler = file_.named("samplers", texture["sampler"]);
      made.wrapU = wrapOf(file_.whole(sampler, "wrapS", kRepeat));
      made.wrapV = wrapOf(file_.whole(sampler, "wrapT", kRepeat));
      made.isSmooth = file_.whole(sampler, "magFilter", kLinear) != kNearest;
    }
  } catch (const FileError& error) {
    lost_.push_back(lostTexture(made.name, error.what()));
    return kNoTexture;
  }
  textures_.push_back(std::move(made));
  return static_cast<std::uint32_t>(textures_.size() - 1);
}

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
