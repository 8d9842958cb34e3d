#include "engine/io/known_formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/file_start.hpp"
#include "engine/io/gaussian_cloud.hpp"
#include "engine/io/ply_header.hpp"
#include "engine/io/zip_archive.hpp"

namespace palpate {

namespace {

constexpr float kHarmonic = 0.28209479f;  // spherical harmonic of degree 0
constexpr std::string_view kPackedLost = "of which the points are the surface: opacity, scale, rotation";

std::string gaussiansText(std::uint64_t count) { return counted(count, "Gaussian"); }
float logitOf(float share) { return std::log(share / (1 - share)); }

void resize(GaussianScene& scene, std::size_t count) {
  scene.centers.resize(count);
  scene.logScales.resize(count);
  scene.rotations.resize(count);
  scene.opacityLogits.resize(count);
  scene.colorHarmonics.resize(count);
}

StoredCloud surface(const std::filesystem::path& path, GaussianScene scene, Log* log, const CloudReadOptions& options) {
  const std::string name = path.filename().string();
  if (log && options.normalsFromFaces) log->say("{}: has no faces to take normals from", name);
  const std::string all = gaussiansText(scene.size());
  StoredCloud stored = surfaceOfGaussians(name, std::move(scene), log);
  stored.lost.push_back(fmt::format("{}, {}", all, kPackedLost));
  return stored;
}

FileContents contentsOfPacked(std::uint64_t count, std::string_view how) {
  FileContents contents;
  contents.elements.push_back({.name = "Gaussian", .count = count, .properties = {}});
  contents.madeFrom =
      fmt::format("a splat scene of {}{}; the points are those of their surface", gaussiansText(count), how);
  return contents;
}

/// The `bits` of `word` from `shift` on, scaled to 0 to 1.
float shareIn(std::uint32_t word, unsigned shift, unsigned bits) {
  const std::uint32_t most = (1u << bits) - 1;
  return static_cast<float>(word >> shift & most) / static_cast<float>(most);
}

// Compressed PLY: chunks of 256 Gaussians with bounds of their positions, scales and optionally colours; the words of
// each Gaussian are relative to these bounds.

constexpr std::size_t kOfChunk = 256, kBoxes = 12, kBoxesWithColor = 18;

struct CompressedHeader {
  PlyInfo info;
  const PlyElement *chunk = nullptr, *vertex = nullptr;
};

bool isCompressed(const PlyInfo& info) {
  const PlyElement *chunk = info.find("chunk"), *vertex = info.find("vertex");
  return chunk && vertex &&
         std::ranges::find(vertex->properties, "packed_position", &PlyProperty::name) != vertex->properties.end();
}

bool holdsCompressed(const std::filesystem::path& path) {
  if (!isFile(path)) return false;
  try {
    return isCompressed(readPlyInfo(path));
  } catch (const FileError&) {  // the reader reports the error
    return false;
  }
}

/// Throws FileError if the elements are not as expected.
void checkCompressed(const std::filesystem::path& path, const PlyInfo& info) {
  constexpr std::array<std::string_view, 4> kWords{"packed_position", "packed_rotation", "packed_scale",
                                                   "packed_color"};
  constexpr std::array<std::string_view, kBoxesWithColor> kBounds{
      "min_x",       "min_y",       "min_z",       "max_x",       "max_y",       "max_z",
      "min_scale_x", "min_scale_y", "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z",
      "min_r",       "min_g",       "min_b",       "max_r",       "max_g",       "max_b"};
  const PlyElement &chunk = *info.find("chunk"), &vertex = *info.find("vertex");
  const auto as = [&](const PlyElement& element, std::span<const std::string_view> names, ScalarType type) {
    if (element.properties.size() != names.size()) return false;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      if (property.name != names[k] || property.isList || property.type != type) return false;
    }
    return true;
  };
  const bool boxes =
      as(chunk, std::span(kBounds).first(kBoxes), ScalarType::f32) || as(chunk, kBounds, ScalarType::f32);
  const bool order = info.elements.size() >= 2 && info.elements[0].name == "chunk" && info.elements[1].name == "vertex";
  const bool right = info.format == PlyFormat::binaryLittleEndian && order && boxes &&
                     as(vertex, kWords, ScalarType::u32) && chunk.count == (vertex.count + kOfChunk - 1) / kOfChunk;
  if (!right)
    throw FileError::atLine(path, vertex.line,
                            "is a compressed splat PLY, but not as SuperSplat writes it (a chunk of boxes for 256 "
                            "Gaussians of four packed words, little-endian); export it uncompressed");
}

/// `words`: of one Gaussian; `boxes`: bounds of its chunk.
void unpackCompressed(GaussianScene& scene, std::size_t i, const std::array<std::uint32_t, 4>& words,
                      std::span<const float> boxes) {
  const auto within = [&](std::size_t box, std::uint32_t word) {
    const std::array shares{shareIn(word, 21, 11), shareIn(word, 11, 10), shareIn(word, 0, 11)};
    Vec3 at;
    for (std::size_t k = 0; k < 3; ++k)
      at[static_cast<int>(k)] = boxes[box + k] + shares[k] * (boxes[box + 3 + k] - boxes[box + k]);
    return at;
  };
  scene.centers[i] = DVec3(within(0, words[0]));
  scene.logScales[i] = within(6, words[2]);
  // The largest component of the rotation is omitted; its index is stored.
  const unsigned largest = words[1] >> 30;
  Vec4 rotation(0);
  float squares = 0;
  for (unsigned k = 0, shift = 20; k < 4; ++k) {
    if (k == largest) continue;
    const float value = (shareIn(words[1], shift, 10) - 0.5f) * std::sqrt(2.f);
    rotation[static_cast<int>(k)] = value;
    squares += value * value;
    shift -= 10;
  }
  rotation[static_cast<int>(largest)] = std::sqrt(std::max(0.f, 1 - squares));
  scene.rotations[i] = rotation;
  for (std::size_t k = 0; k < 3; ++k) {
    float color = shareIn(words[3], static_cast<unsigned>(24 - 8 * k), 8);
    if (boxes.size() == kBoxesWithColor) color = boxes[12 + k] + color * (boxes[15 + k] - boxes[12 + k]);
    scene.colorHarmonics[i][static_cast<int>(k)] = (color - 0.5f) / kHarmonic;
  }
  scene.opacityLogits[i] = logitOf(shareIn(words[3], 0, 8));
}

GaussianScene readCompressedScene(const std::filesystem::path& path, Log* log) {
  ChunkedFile file(path);
  if (log) file.onProgress([&](double share) { log->progress(path.filename().string(), share); });
  const PlyInfo info = readPlyHeader(file);
  checkCompressed(path, info);
  const PlyElement &chunk = *info.find("chunk"), &vertex = *info.find("vertex");
  constexpr std::size_t kWordBytes = 16;
  const std::size_t chunkFloats = chunk.properties.size();
  const auto left = file.remaining();
  if (!left || chunk.count > *left / (4 * chunkFloats) || vertex.count > *left / kWordBytes ||
      4 * chunkFloats * chunk.count + kWordBytes * vertex.count > *left)
    throw FileError::atByte(path, file.offset(),
                            fmt::format("the header promises {} chunks and {}, for which the file is too short; it is "
                                        "truncated, or its header is wrong",
                                        chunk.count, gaussiansText(vertex.count)));
  std::vector<float> boxes(chunkFloats * chunk.count);
  const auto read = [&](void* to, std::size_t bytes) {
    const auto there = file.peek(bytes);
    if (there.size() < bytes) throw FileError::atByte(path, file.offset() + there.size(), "the file ends too early");
    std::memcpy(to, there.data(), bytes);
    file.consume(bytes);
  };
  for (std::size_t k = 0; k < chunk.count; ++k) read(boxes.data() + k * chunkFloats, 4 * chunkFloats);
  GaussianScene scene;
  resize(scene, vertex.count);
  for (std::size_t i = 0; i < vertex.count; ++i) {
    std::array<std::uint32_t, 4> words;
    read(words.data(), kWordBytes);
    unpackCompressed(scene, i, words, std::span(boxes).subspan(i / kOfChunk * chunkFloats, chunkFloats));
  }
  return scene;
}

FileContents contentsOfCompressed(const std::filesystem::path& path) {
  const PlyInfo info = readPlyInfo(path);
  checkCompressed(path, info);
  return contentsOfPacked(info.find("vertex")->count, ", packed");
}

StoredCloud readCompressed(const std::filesystem::path& path, Log* log, const CloudReadOptions& options) {
  StoredCloud stored = surface(path, readCompressedScene(path, log), log, options);
  for (const PlyElement& element : readPlyInfo(path).elements)
    if (element.name != "chunk" && element.name != "vertex")
      stored.lost.push_back(fmt::format("{} {}, colours by the direction of view", element.count, element.name));
  return stored;
}

// .splat: 32 bytes for each Gaussian, without a header.

constexpr std::size_t kSplatBytes = 32;

std::uint64_t splatsIn(const std::filesystem::path& path, const ChunkedFile& file) {
  const auto bytes = file.remaining();
  if (!bytes) throw FileError(path, "is a pipe; a .splat can only be read from a file");
  if (*bytes == 0) throw FileError(path, "is empty");
  if (*bytes % kSplatBytes != 0)
    throw FileError::atByte(path, *bytes - *bytes % kSplatBytes,
                            fmt::format("{} bytes are not a whole number of splats of {} bytes; the file is truncated, "
                                        "or is not a .splat",
                                        *bytes, kSplatBytes));
  return *bytes / kSplatBytes;
}

FileContents contentsOfSplat(const std::filesystem::path& path) {
  return contentsOfPacked(splatsIn(path, ChunkedFile(path)), "");
}

StoredCloud readSplat(const std::filesystem::path& path, Log* log, const CloudReadOptions& options) {
  ChunkedFile file(path);
  if (log) file.onProgress([&](double share) { log->progress(path.filename().string(), share); });
  const std::uint64_t count = splatsIn(path, file);
  GaussianScene scene;
  resize(scene, count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = file.peek(kSplatBytes);
    if (row.size() < kSplatBytes) throw FileError::atByte(path, file.offset() + row.size(), "the file ends too early");
    std::array<float, 6> numbers;  // position, then standard deviations
    std::memcpy(numbers.data(), row.data(), sizeof numbers);
    const auto byte = [&](std::size_t k) { return static_cast<float>(std::to_integer<unsigned>(row[24 + k])); };
    for (int k = 0; k < 3; ++k) {
      scene.centers[i][k] = numbers[static_cast<std::size_t>(k)];
      scene.logScales[i][k] = std::log(numbers[3 + static_cast<std::size_t>(k)]);
      scene.colorHarmonics[i][k] = (byte(static_cast<std::size_t>(k)) / 255 - 0.5f) / kHarmonic;
    }
    scene.opacityLogits[i] = logitOf(byte(3) / 255);
    for (int k = 0; k < 4; ++k) scene.rotations[i][k] = (byte(4 + static_cast<std::size_t>(k)) - 128) / 128;
    file.consume(kSplatBytes);
  }
  return surface(path, std::move(scene), log, options);
}

// SPZ: a header of 16 bytes, followed by positions, opacities, colours, scales, rotations and harmonics of all
// Gaussians.

constexpr std::uint32_t kSpzMagic = 0x5053474e;  // "NGSP"
constexpr std::size_t kSpzHead = 16;

struct SpzHeader {
  std::uint32_t version = 0, count = 0;
  unsigned degree = 0, fractionBits = 0;

  std::size_t rotationBytes() const { return version == 2 ? 3 : 4; }
  std::size_t rowBytes() const { return 9 + 1 + 3 + 3 + rotationBytes(); }
};

SpzHeader spzHeader(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  if (bytes.size() < kSpzHead || loadScalar<std::uint32_t>(bytes.data()) != kSpzMagic)
    throw FileError(path, "is compressed (gzip) and contains no SPZ; unpack it first");
  SpzHeader head{.version = loadScalar<std::uint32_t>(bytes.data() + 4),
                 .count = loadScalar<std::uint32_t>(bytes.data() + 8),
                 .degree = std::to_integer<unsigned>(bytes[12]),
                 .fractionBits = std::to_integer<unsigned>(bytes[13])};
  if (head.version != 2 && head.version != 3)
    throw FileError(
        path, fmt::format("is SPZ of version {}; versions 2 and 3 are read, export one of those or PLY", head.version));
  if (head.degree > 4 || head.fractionBits > 23)
    throw FileError(path, "is SPZ with an invalid header: its degree or its bits of fractions are too large");
  if (const std::uint64_t wanted = kSpzHead + std::uint64_t{head.count} * head.rowBytes(); wanted > bytes.size())
    throw FileError(path, fmt::format("promises {}, for which its {} unpacked bytes are too few",
                                      gaussiansText(head.count), bytes.size()));
  return head;
}

std::vector<std::byte> unpackedSpz(const std::filesystem::path& path) {
  ChunkedFile file(path);
  std::vector<std::byte> bytes;
  for (auto piece = file.peek(1); !piece.empty(); piece = file.peek(1)) {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
    file.consume(piece.size());
  }
  if (bytes.size() >= 4 && loadScalar<std::uint32_t>(bytes.data()) == kSpzMagic)
    throw FileError(path, "is SPZ of version 4 or later, which is not read; export SPZ of version 2 or 3, or PLY");
  return unpackGzip(path, bytes);
}

/// w x y z, from x y z in three bytes, or from the three smallest components in ten bits each and the index of the
/// largest.
Vec4 spzRotation(const SpzHeader& head, const std::byte* at) {
  Vec4 xyzw(0);
  if (head.version == 2) {
    float squares = 0;
    for (int k = 0; k < 3; ++k) {
      xyzw[k] = static_cast<float>(std::to_integer<unsigned>(at[k])) / 127.5f - 1;
      squares += xyzw[k] * xyzw[k];
    }
    xyzw[3] = std::sqrt(std::max(0.f, 1 - squares));
  } else {
    auto word = loadScalar<std::uint32_t>(at);
    const int largest = static_cast<int>(word >> 30);
    float squares = 0;
    for (int k = 3; k >= 0; --k) {
      if (k == largest) continue;
      const float size = static_cast<float>(word & 511u) / 511.f * std::sqrt(0.5f);
      xyzw[k] = word >> 9 & 1u ? -size : size;
      squares += size * size;
      word >>= 10;
    }
    xyzw[largest] = std::sqrt(std::max(0.f, 1 - squares));
  }
  return {xyzw[3], xyzw[0], xyzw[1], xyzw[2]};
}

GaussianScene spzScene(const SpzHeader& head, std::span<const std::byte> bytes) {
  constexpr float kColorScale = 0.15f, kScaleSteps = 16, kMinScale = -10;
  GaussianScene scene;
  const std::size_t count = head.count;
  resize(scene, count);
  const std::byte* places = bytes.data() + kSpzHead;
  const std::byte *opacities = places + 9 * count, *colors = opacities + count, *scales = colors + 3 * count,
                  *rotations = scales + 3 * count;
  const auto value = [](const std::byte* at) { return static_cast<float>(std::to_integer<unsigned>(*at)); };
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::byte* at = places + 9 * i + 3 * k;
      std::int32_t fixed = 0;
      for (unsigned byte = 0; byte < 3; ++byte) fixed |= std::to_integer<std::int32_t>(at[byte]) << (8 * byte);
      if (fixed & 0x800000) fixed -= 0x1000000;
      const int axis = static_cast<int>(k);
      scene.centers[i][axis] = std::ldexp(static_cast<double>(fixed), -static_cast<int>(head.fractionBits));
      scene.colorHarmonics[i][axis] = (value(colors + 3 * i + k) / 255 - 0.5f) / kColorScale;
      scene.logScales[i][axis] = value(scales + 3 * i + k) / kScaleSteps + kMinScale;
    }
    scene.opacityLogits[i] = logitOf(value(opacities + i) / 255);
    scene.rotations[i] = spzRotation(head, rotations + head.rotationBytes() * i);
  }
  return scene;
}

FileContents contentsOfSpz(const std::filesystem::path& path) {
  const SpzHeader head = spzHeader(path, unpackedSpz(path));
  return contentsOfPacked(head.count, fmt::format(" of degree {}", head.degree));
}

StoredCloud readSpz(const std::filesystem::path& path, Log* log, const CloudReadOptions& options) {
  const std::vector<std::byte> bytes = unpackedSpz(path);
  const SpzHeader head = spzHeader(path, bytes);
  StoredCloud stored = surface(path, spzScene(head, bytes), log, options);
  if (head.degree > 0) stored.lost.emplace_back("colours by the direction of view");
  stored.cloud.storedAs.comments.emplace_back("comment up: y");  // as defined by the format
  return stored;
}

}  // namespace

CloudFormat compressedPlyFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".compressed.ply"};
  return {.name = "compressed 3DGS",
          .endings = kEndings,
          .holds = holdsCompressed,
          .contents = contentsOfCompressed,
          .read = readCompressed};
}

CloudFormat splatFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".splat"};
  return {.name = "splat", .endings = kEndings, .contents = contentsOfSplat, .read = readSplat};
}

CloudFormat spzFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".spz"};
  return {.name = "SPZ",
          .endings = kEndings,
          .begins = [](const FileStart& start) { return start.startsWith("\x1f\x8b") || start.startsWith("NGSP"); },
          .contents = contentsOfSpz,
          .read = readSpz};
}

}  // namespace palpate
