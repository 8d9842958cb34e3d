// Image files of depth and colour cameras, and pictures within other files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace palpate {

/// A 16-bit value for each pixel, row by row from the top.
struct GreyImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint16_t> values;
};

/// Red, green and blue of each pixel, row by row from the top.
struct ColorImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::array<std::uint8_t, 3>> rgb;
};

/// Maximum side of an image, and of a texture, pixels.
inline constexpr std::uint32_t kLongestImageSide = 8192, kLongestTextureSide = 16384;

struct ImageSize {
  std::uint32_t width = 0, height = 0;
  bool operator==(const ImageSize&) const = default;
};
/// Size from the file's header, without decoding pixels. Throws FileError if the file is neither PNG nor JPEG.
ImageSize imageSizeOf(const std::filesystem::path& file);

/// A grey PNG of 16 bits. Both functions throw FileError for another kind of file, for a damaged or truncated one,
/// and for sides beyond kLongestImageSide; memory is allocated only if the file is long enough to fill it.
GreyImage readGreyImage(const std::filesystem::path& file);
/// A PNG or a JPEG of 8 bits, grey or coloured; transparency is ignored.
ColorImage readColorImage(const std::filesystem::path& file, std::uint32_t longestSide = kLongestImageSide);
/// The same of bytes that are a part of `file`.
ColorImage colorImageIn(const std::filesystem::path& file, std::span<const std::byte> bytes,
                        std::uint32_t longestSide = kLongestImageSide);

/// Nearest-neighbour scaling to another size; `image` must not be empty.
ColorImage resized(const ColorImage& image, ImageSize size);

}  // namespace palpate
