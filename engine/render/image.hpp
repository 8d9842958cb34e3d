// Pictures on the host and the files they become.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace palpate {

/// Rows from the top; one RGBA8 word per pixel, red in the lowest byte.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::array<std::uint8_t, 4>> rgba;

  const std::array<std::uint8_t, 4>& at(std::uint32_t x, std::uint32_t y) const {
    return rgba[std::size_t{y} * width + x];
  }
};

/// Eye-space depth, rows from the top, model units; 0 where nothing is.
struct DepthImage {
  std::uint32_t width = 0, height = 0;
  std::vector<float> depth;

  float at(std::uint32_t x, std::uint32_t y) const { return depth[std::size_t{y} * width + x]; }
};

enum class ImageFormat : std::uint8_t { png, jpeg };
/// By the ending of the name, in any case; a device or a pipe without one gets a PNG. Throws UsageError, naming the
/// endings that there are, for another one.
ImageFormat imageFormatOf(const std::filesystem::path& path);

/// Writes what the name says. The same picture gives the same bytes. A PNG holds every pixel, a JPEG no alpha and what
/// the eye sees. Throws FileError, and UsageError as imageFormatOf() does.
void writeImage(const std::filesystem::path& path, const Image& image);
/// Portable float map, one channel, little-endian. Throws FileError.
void writePfm(const std::filesystem::path& path, const DepthImage& image);

}  // namespace palpate
