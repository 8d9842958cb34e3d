#include "engine/io/image_file.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

#include "engine/core/error.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/zip_archive.hpp"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace palpate {

namespace {

static_assert(STBI_MAX_DIMENSIONS == kLongestTextureSide);

constexpr std::size_t kMaxBytes = std::size_t{1} << 29;  // of a file: half the bytes of the largest texture
// Upper bound of pixels per byte: deflate's longest runs (1032 bytes) of 1-bit pixels; a JPEG has at least one bit for
// 64 pixels.
constexpr std::uint64_t kMaxPixelsPerByte = std::uint64_t{8} * 1032;

using Bytes = std::vector<std::byte>;
using Pixels = std::unique_ptr<void, decltype(&std::free)>;

constexpr std::string_view kPngMagic("\x89PNG\r\n\x1a\n", 8);
constexpr std::string_view kJpegMagic("\xff\xd8\xff", 3);

std::string_view textOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Bytes readWhole(const std::filesystem::path& path) {
  ChunkedFile file(path);
  Bytes bytes;
  for (std::span<const std::byte> piece = file.peek(1); !piece.empty(); piece = file.peek(1)) {
    if (bytes.size() + piece.size() > kMaxBytes)
      throw FileError(path, fmt::format("has more than {} bytes, the maximum of a picture", kMaxBytes));
    bytes.insert(bytes.end(), piece.begin(), piece.end());
    file.consume(piece.size());
  }
  return bytes;
}

std::uint32_t bigEndian(std::span<const std::byte> bytes) {
  std::uint32_t value = 0;
  for (const std::byte byte : bytes.first(4)) value = value << 8 | std::to_integer<std::uint32_t>(byte);
  return value;
}

/// The decoder does not verify checksums, and a flipped bit would be a wrong depth that is felt.
void requireWholePng(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  constexpr std::size_t kFrame = 12;  // length, name and checksum of a chunk
  for (std::size_t at = kPngMagic.size(); at < bytes.size();) {
    const std::span<const std::byte> rest = bytes.subspan(at);
    const std::uint64_t length = rest.size() < kFrame ? 0 : bigEndian(rest);
    if (rest.size() < kFrame + length) break;
    const std::span<const std::byte> chunk = rest.subspan(4, 4 + length);
    if (zipChecksum(chunk) != bigEndian(rest.subspan(8 + length)))
      throw FileError::atByte(file, at, "is damaged: the checksum of this chunk does not match");
    if (textOf(chunk.first(4)) == "IEND") return;
    at += kFrame + length;
  }
  throw FileError::atByte(file, bytes.size(), "ends within the picture; copy it again");
}

/// The decoder fills missing parts with grey.
void requireWholeJpeg(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  const std::string_view text = textOf(bytes);
  const std::size_t scan = text.rfind("\xff\xda"), end = text.rfind("\xff\xd9");
  if (scan == text.npos || end == text.npos || end < scan)
    throw FileError::atByte(file, bytes.size(), "ends within the picture; copy it again");
}

struct Head {
  ImageSize size;
  int channels = 0;
  bool isPng = false;
};

int lengthOf(std::span<const std::byte> bytes) { return static_cast<int>(bytes.size()); }
const stbi_uc* dataOf(std::span<const std::byte> bytes) { return reinterpret_cast<const stbi_uc*>(bytes.data()); }

Head headOf(const std::filesystem::path& file, std::span<const std::byte> bytes,
            std::uint32_t longestSide = kLongestImageSide) {
  const std::string_view text = textOf(bytes);
  Head head{.size = {}, .channels = 0, .isPng = text.starts_with(kPngMagic)};
  if (text.empty()) throw FileError(file, "is empty; copy it again");
  if (!head.isPng && !text.starts_with(kJpegMagic)) throw FileError(file, "is neither a PNG nor a JPEG");
  int width = 0, height = 0;
  if (!stbi_info_from_memory(dataOf(bytes), lengthOf(bytes), &width, &height, &head.channels))
    throw FileError(file, fmt::format("has a header that cannot be read: {}; a side has at most {} pixels",
                                      stbi_failure_reason(), longestSide));
  head.size = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
  if (std::max(head.size.width, head.size.height) > longestSide)
    throw FileError(file, fmt::format("has {} x {} pixels; a side has at most {}", width, height, longestSide));
  if (std::uint64_t{head.size.width} * head.size.height > kMaxPixelsPerByte * bytes.size())
    throw FileError(file, fmt::format("claims {} x {} pixels, but ends after {} bytes; copy it again", width, height,
                                      bytes.size()));
  return head;
}

void requireWhole(const std::filesystem::path& file, const Head& head, std::span<const std::byte> bytes) {
  if (head.isPng)
    requireWholePng(file, bytes);
  else
    requireWholeJpeg(file, bytes);
}

[[noreturn]] void failDecoding(const std::filesystem::path& file) {
  throw FileError(file, fmt::format("cannot be decoded: {}; write it again", stbi_failure_reason()));
}

}  // namespace

ImageSize imageSizeOf(const std::filesystem::path& file) { return headOf(file, readWhole(file)).size; }

GreyImage readGreyImage(const std::filesystem::path& file) {
  const Bytes bytes = readWhole(file);
  const Head head = headOf(file, bytes);
  if (!head.isPng || head.channels != 1 || !stbi_is_16_bit_from_memory(dataOf(bytes), lengthOf(bytes)))
    throw FileError(file, "is not a grey PNG of 16 bits, in which depth is stored");
  requireWhole(file, head, bytes);
  int width = 0, height = 0, channels = 0;
  const Pixels pixels(stbi_load_16_from_memory(dataOf(bytes), lengthOf(bytes), &width, &height, &channels, 1),
                      std::free);
  if (!pixels) failDecoding(file);
  GreyImage image{.width = head.size.width, .height = head.size.height, .values = {}};
  image.values.resize(std::size_t{image.width} * image.height);
  std::memcpy(image.values.data(), pixels.get(), image.values.size() * sizeof(std::uint16_t));
  return image;
}

ColorImage readColorImage(const std::filesystem::path& file, std::uint32_t longestSide) {
  return colorImageIn(file, readWhole(file), longestSide);
}

ColorImage colorImageIn(const std::filesystem::path& file, std::span<const std::byte> bytes,
                        std::uint32_t longestSide) {
  const Head head = headOf(file, bytes, longestSide);
  requireWhole(file, head, bytes);
  int width = 0, height = 0, channels = 0;
  const Pixels pixels(stbi_load_from_memory(dataOf(bytes), lengthOf(bytes), &width, &height, &channels, 3), std::free);
  if (!pixels) failDecoding(file);
  ColorImage image{.width = head.size.width, .height = head.size.height, .rgb = {}};
  image.rgb.resize(std::size_t{image.width} * image.height);
  std::memcpy(image.rgb.data(), pixels.get(), image.rgb.size() * sizeof image.rgb[0]);
  return image;
}

ColorImage resized(const ColorImage& image, ImageSize size) {
  ColorImage made{.width = size.width, .height = size.height, .rgb = {}};
  made.rgb.reserve(std::size_t{size.width} * size.height);
  // The pixel under the centre of the new one.
  const auto nearest = [](std::uint32_t at, std::uint32_t to, std::uint32_t from) {
    return static_cast<std::size_t>((2 * std::uint64_t{at} + 1) * from / (2 * std::uint64_t{to}));
  };
  for (std::uint32_t y = 0; y < size.height; ++y)
    for (std::uint32_t x = 0; x < size.width; ++x)
      made.rgb.push_back(
          image.rgb[nearest(y, size.height, image.height) * image.width + nearest(x, size.width, image.width)]);
  return made;
}

}  // namespace palpate
