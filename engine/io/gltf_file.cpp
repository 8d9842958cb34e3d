#include "engine/io/gltf_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/io/chunked_file.hpp"
#include "engine/io/ends_after.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/unpacked_view.hpp"

namespace palpate {

namespace {

using Json = nlohmann::json;
using Bytes = std::vector<std::byte>;

constexpr std::uint32_t kMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;  // "glTF", JSON, BIN

constexpr const char* kMeshopt = "EXT_meshopt_compression";

Bytes readWhole(const std::filesystem::path& path) {
  ChunkedFile file(path);
  Bytes bytes;
  for (auto piece = file.peek(1); !piece.empty(); piece = file.peek(1)) {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
    file.consume(piece.size());
  }
  return bytes;
}

/// Little-endian, at most four bytes.
std::uint32_t bitsAt(const std::byte* at, std::size_t bytes) {
  std::uint32_t bits = 0;
  for (std::size_t k = 0; k < bytes; ++k) bits |= std::to_integer<std::uint32_t>(at[k]) << (8 * k);
  return bits;
}

unsigned numbersOfType(std::string_view type) {
  constexpr std::string_view kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  const auto found = std::ranges::find(kTypes, type);
  return found == std::end(kTypes) ? 0 : static_cast<unsigned>(found - std::begin(kTypes)) + 1;
}

int digitOf(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
}

/// `before`: number of bytes of the file before the text.
std::unique_ptr<const Json> parsed(const std::filesystem::path& path, std::span<const std::byte> bytes,
                                   std::size_t before) {
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  try {
    auto json = std::make_unique<const Json>(Json::parse(text, text + bytes.size()));
    if (json->is_object()) return json;
  } catch (const Json::parse_error& error) {
    throw FileError::atByte(path, before + error.byte,
                            error.byte > bytes.size() ? "the file ends inside its JSON" : "invalid JSON");
  } catch (const Json::exception&) {  // a number that is too large
  }
  throw FileError::atByte(path, before, "the JSON from here on is not glTF");
}

/// Decodes base64 up to the first invalid character.
Bytes fromBase64(std::string_view text) {
  Bytes bytes;
  std::uint32_t bits = 0;
  unsigned held = 0;
  for (const char c : text) {
    const int digit = digitOf(c);
    if (digit < 0) break;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    held += 6;
    if (held >= 8) bytes.push_back(static_cast<std::byte>(bits >> (held -= 8) & 0xff));
  }
  return bytes;
}

/// Replaces percent escapes (%20 by a space, and so on).
std::string unescaped(std::string_view uri) {
  std::string out;
  for (std::size_t k = 0; k < uri.size(); ++k) {
    const auto hex = [](char c) {
      return c >= '0' && c <= '9'   ? c - '0'
             : c >= 'a' && c <= 'f' ? c - 'a' + 10
             : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                    : -1;
    };
    if (uri[k] == '%' && k + 2 < uri.size() && hex(uri[k + 1]) >= 0 && hex(uri[k + 2]) >= 0) {
      out += static_cast<char>(16 * hex(uri[k + 1]) + hex(uri[k + 2]));
      k += 2;
    } else {
      out += uri[k];
    }
  }
  return out;
}

}  // namespace

unsigned bytesOfGltfKind(std::size_t kind) {
  switch (kind) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

double GltfNumbers::number(std::size_t element, std::size_t k) const {
  const std::size_t bytes = bytesOfGltfKind(kind);
  const std::uint32_t bits = bitsAt(data + element * stride + k * bytes, bytes);
  const auto share = [&](double value, double most) { return normalized ? std::max(value / most, -1.0) : value; };
  switch (kind) {
    case 5120:
      return share(static_cast<std::int8_t>(bits), 127);
    case 5121:
      return share(bits, 255);
    case 5122:
      return share(static_cast<std::int16_t>(bits), 32767);
    case 5123:
      return share(bits, 65535);
    case 5125:
      return bits;
    default: {
      float value;
      std::memcpy(&value, &bits, sizeof value);
      return static_cast<double>(value);
    }
  }
}

std::uint32_t GltfNumbers::index(std::size_t element) const {
  return bitsAt(data + element * stride, bytesOfGltfKind(kind));
}

GltfFile::GltfFile(std::filesystem::path file) : path_(std::move(file)) {
  const Bytes all = readWhole(path_);
  if (all.empty()) fail("is empty");
  if (all.size() >= 4 && bitsAt(all.data(), 4) == kMagic) {
    readGlb(all);
  } else {
    json_ = parsed(path_, all, 0);
  }
  if (!json_) fail("is not a glTF file: its JSON is not an object");
  const auto asset = json_->find("asset");
  if (asset == json_->end() || !asset->is_object() || !asset->contains("version") || !(*asset)["version"].is_string())
    fail("does not state its version of glTF");
  const std::string version = (*asset)["version"];
  if (!version.starts_with("2.")) fail(fmt::format("is glTF {}; only versions 2.x can be read", inQuotes(version)));
}

GltfFile::~GltfFile() = default;

void GltfFile::readGlb(const Bytes& all) {
  constexpr std::size_t kHead = 12, kChunkHead = 8;
  if (all.size() < kHead) throw FileError::atByte(path_, all.size(), "the file ends within its header");
  if (const std::uint32_t version = bitsAt(all.data() + 4, 4); version != 2)
    throw FileError::atByte(path_, 4, fmt::format("GLB of version {}; version 2 is read", version));
  const std::uint32_t said = bitsAt(all.data() + 8, 4);
  if (said > all.size()) throw endsAfter(path_, all.size(), all.size(), said, "bytes");
  if (said != all.size())
    throw FileError::atByte(path_, 8,
                            fmt::format("states a length of {} bytes, but the file has {}", said, all.size()));
  for (std::size_t at = kHead, chunk = 0; at < all.size(); ++chunk) {
    if (all.size() - at < kChunkHead) throw FileError::atByte(path_, at, "the file ends within a part's header");
    const std::size_t bytes = bitsAt(all.data() + at, 4);
    const std::uint32_t kind = bitsAt(all.data() + at + 4, 4);
    if (bytes > all.size() - at - kChunkHead)
      throw FileError::atByte(
          path_, at, fmt::format("a part of {} bytes, of which only {} follow", bytes, all.size() - at - kChunkHead));
    const std::byte* begin = all.data() + at + kChunkHead;
    if ((chunk == 0) != (kind == kJsonChunk))
      throw FileError::atByte(path_, at + 4, "its JSON must be its first part, and the only part of JSON");
    if (chunk == 0) {
      json_ = parsed(path_, {begin, bytes}, at + kChunkHead);
    } else if (kind == kBinaryChunk && !hasPacked_) {
      packed_.assign(begin, begin + bytes);
      hasPacked_ = true;
    }
    at += kChunkHead + bytes;
  }
}

std::size_t GltfFile::whole(const Json& object, const char* name, std::size_t otherwise) const {
  const auto found = object.find(name);
  if (found == object.end()) return otherwise;
  if (!found->is_number_unsigned()) fail(fmt::format("\"{}\" is not a whole number of 0 or more", name));
  return found->get<std::size_t>();
}

const Json& GltfFile::named(const char* list, const Json& number) const {
  const auto all = json_->find(list);
  const std::size_t count = all != json_->end() && all->is_array() ? all->size() : 0;
  if (!number.is_number_unsigned() || number.get<std::size_t>() >= count)
    fail(fmt::format("\"{}\" has {} elements; {} is out of range", list, count,
                     inQuotes(number.dump(-1, ' ', true, Json::error_handler_t::replace))));
  const Json& element = (*all)[number.get<std::size_t>()];
  if (!element.is_object()) fail(fmt::format("\"{}\" has an entry that is not an object", list));
  return element;
}

const Json* GltfFile::extension(const Json& object, const char* name) const {
  const auto all = object.find("extensions");
  if (all == object.end() || !all->is_object()) return nullptr;
  const auto found = all->find(name);
  if (found == all->end()) return nullptr;
  if (!found->is_object()) fail(fmt::format("\"{}\" is not an object", name));
  return &*found;
}

Bytes GltfFile::bytesAt(const Json& uri, std::string_view what) const {
  if (!uri.is_string()) fail(fmt::format("the \"uri\" of {} is not a text", what));
  const std::string text = uri;
  if (text.starts_with("data:")) {
    const std::size_t comma = text.find(',');
    if (comma == text.npos || !text.substr(0, comma).ends_with(";base64"))
      fail(fmt::format("the data of {} are not base64", what));
    return fromBase64(std::string_view(text).substr(comma + 1));
  }
  const std::filesystem::path beside = unescaped(text);
  const bool leaves = beside.empty() || beside.is_absolute() || beside.has_root_path() ||
                      text.find("://") != text.npos || std::ranges::find(beside, "..") != beside.end();
  if (leaves) fail(fmt::format("{} is {}, which is not the name of a file beside this one", what, inQuotes(text)));
  const std::filesystem::path file = path_.parent_path() / beside;
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown))
    fail(fmt::format("{} is {}, and there is no such file beside this one", what, inQuotes(text)));
  return readWhole(file);
}

std::span<const std::byte> GltfFile::partOf(const Json& view) {
  const Json number = view.contains("buffer") ? view["buffer"] : Json();
  const Json& buffer = named("buffers", number);
  const std::size_t which = number.get<std::size_t>();
  if (buffers_.empty()) buffers_.resize((*json_)["buffers"].size());
  Bytes& bytes = buffers_[which];
  if (bytes.empty() && buffer.contains("uri")) {
    bytes = bytesAt(buffer["uri"], fmt::format("buffer {}", which));
  } else if (bytes.empty()) {
    if (which != 0 || !hasPacked_)
      fail(fmt::format("buffer {} has no URI, and the file contains no data for it", which));
    bytes = packed_;
  }
  const std::size_t from = whole(view, "byteOffset", 0), length = whole(view, "byteLength", 0);
  if (from > bytes.size() || length > bytes.size() - from)
    fail(fmt::format("a view of {} bytes from byte {} on exceeds its buffer of {}", length, from, bytes.size()));
  return {bytes.data() + from, length};
}

std::span<const std::byte> GltfFile::view(const Json& number) {
  const Json& view = named("bufferViews", number);
  const Json* packed = extension(view, kMeshopt);
  if (!packed) return partOf(view);
  const auto [found, isNew] = unpacked_.try_emplace(number.get<std::size_t>());
  if (isNew) found->second = unpacked(*packed);
  return found->second;
}

Bytes GltfFile::unpacked(const Json& packed) {
  PackedView view{
      .bytes = partOf(packed), .count = whole(packed, "count", 0), .stride = whole(packed, "byteStride", 0)};
  const auto text = [&](const char* name, const char* otherwise) {
    const auto found = packed.find(name);
    return found != packed.end() && found->is_string() ? found->get<std::string>() : std::string(otherwise);
  };
  view.mode = text("mode", ""), view.filter = text("filter", "NONE");
  try {
    return unpackView(view);
  } catch (const Error& error) {
    fail(fmt::format("{}: {}", kMeshopt, error.what()));
  }
}

Bytes GltfFile::picture(const Json& number) {
  const Json& image = named("images", number);
  const std::size_t which = number.get<std::size_t>();
  if (image.contains("uri")) return bytesAt(image["uri"], fmt::format("image {}", which));
  if (!image.contains("bufferView")) fail(fmt::format("image {} has neither a URI nor data", which));
  const std::span<const std::byte> bytes = view(image["bufferView"]);
  return {bytes.begin(), bytes.end()};
}

GltfNumbers GltfFile::numbers(const Json& accessor, std::initializer_list<unsigned> perElement) {
  const Json& json = named("accessors", accessor);
  if (json.contains("sparse") || !json.contains("bufferView"))
    fail("an accessor is sparse, which is not read; export it with all its numbers");
  const std::span<const std::byte> bytes = view(json["bufferView"]);
  GltfNumbers numbers = described(json, perElement);
  const std::size_t element = std::size_t{bytesOfGltfKind(numbers.kind)} * numbers.perElement;
  numbers.stride = whole(named("bufferViews", json["bufferView"]), "byteStride", element);
  if (numbers.stride < element || numbers.stride > 252 + element)
    fail(fmt::format("a view with a stride of {} bytes for elements of {}", numbers.stride, element));
  const std::size_t skip = whole(json, "byteOffset", 0), length = bytes.size();
  const bool fits = numbers.count == 0 || (skip <= length && element <= length - skip &&
                                           (numbers.count - 1) <= (length - skip - element) / numbers.stride);
  if (!fits)
    fail(fmt::format("an accessor of {} elements from byte {} on exceeds its view of {}", numbers.count, skip, length));
  numbers.data = bytes.data() + skip;
  return numbers;
}

GltfNumbers GltfFile::described(const Json& accessor, std::initializer_list<unsigned> perElement) const {
  GltfNumbers numbers{.count = whole(accessor, "count", 0)};
  const std::size_t kind = whole(accessor, "componentType", 0);
  const auto type = accessor.find("type");
  numbers.perElement =
      type != accessor.end() && type->is_string() ? numbersOfType(type->get_ref<const std::string&>()) : 0;
  if (bytesOfGltfKind(kind) == 0 || std::ranges::find(perElement, numbers.perElement) == perElement.end())
    fail("an accessor is of a type that its use does not allow");
  numbers.kind = static_cast<unsigned>(kind);
  const auto normalized = accessor.find("normalized");
  numbers.normalized = normalized != accessor.end() && normalized->is_boolean() && normalized->get<bool>();
  return numbers;
}

}  // namespace palpate
