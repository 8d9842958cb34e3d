// Pictures on the host, and writing them to files.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace palpate {

/// Rows from the top; one RGBA8 word per pixel, red in the lowest byte. Colours are not multiplied by opacity.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::array<std::uint8_t, 4>> rgba;

  const std::array<std::uint8_t, 4>& at(std::uint32_t x, std::uint32_t y) const {
    return rgba[std::size_t{y} * width + x];
  }
};

/// Eye-space depth, rows from the top, model units; 0 without a surface.
struct DepthImage {
  std::uint32_t width = 0, height = 0;
  std::vector<float> depth;

  float at(std::uint32_t x, std::uint32_t y) const { return depth[std::size_t{y} * width + x]; }
};

enum class ImageFormat : std::uint8_t { png, jpeg };
/// By the extension of the name, in any case; a device or a pipe without one gets a PNG. Throws UsageError for others,
/// listing the known extensions.
ImageFormat imageFormatOf(const std::filesystem::path& path);

/// Writes the format that the name implies. The same picture gives the same bytes. PNG is lossless; JPEG is lossy and
/// has no alpha. Throws FileError, and UsageError like imageFormatOf().
void writeImage(const std::filesystem::path& path, const Image& image);
/// Portable float map, one channel, little-endian. Throws FileError.
void writePfm(const std::filesystem::path& path, const DepthImage& image);

}  // namespace palpate
