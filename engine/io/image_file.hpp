// Pictures in files: what depth and colour cameras wrote.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace palpate {

/// One value of 16 bits for each pixel, row by row from the top.
struct GreyImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint16_t> values;
};

/// Red, green and blue of each pixel, row by row from the top.
struct ColorImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::array<std::uint8_t, 3>> rgb;
};

/// The longest side of a picture that is read, pixels.
inline constexpr std::uint32_t kLongestImageSide = 8192;

struct ImageSize {
  std::uint32_t width = 0, height = 0;
  bool operator==(const ImageSize&) const = default;
};
/// As the file's head says it; no pixel is decoded. Throws FileError for what is neither a PNG nor a JPEG.
ImageSize imageSizeOf(const std::filesystem::path& file);

/// A grey PNG of 16 bits. All of them throw FileError for another kind of file, for one that is damaged or cut off, and
/// for sides beyond kLongestImageSide; memory is taken only where the file is long enough to fill it.
GreyImage readGreyImage(const std::filesystem::path& file);
/// A PNG or a JPEG of 8 bits, grey or coloured; what is transparent is not.
ColorImage readColorImage(const std::filesystem::path& file);

/// Of another size, each pixel the nearest of `image`, which has one.
ColorImage resized(const ColorImage& image, ImageSize size);

}  // namespace palpate
